"""What share of random mutants the tests kill: python tools/mutants.py --count 100 --seed 13

Draws mutants of all sites in src/ratestate (mutations.py), each site as likely as any other, and
runs for each the tests of its part in a copy of the tree, the quickest first, until one fails.
The tests of a part are those that call its function.  What no test calls as Python (a kernel, a
constant) has the tests of the functions that name it.  A test that takes far longer than it used to
has killed its mutant too.

All is kept under build/mutants: what each test calls, gathered once for each version of a test
file; and results.jsonl, from which a run goes on.  A survivor is tried again once tests changed.
"""

import argparse
import contextlib
import hashlib
import json
import os
import queue
import random
import shutil
import signal
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mutations

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build/mutants"
RESULTS = BUILD / "results.jsonl"
KERNELS = ("ratestate/engine/", "ratestate/laws.py")  # compile anew when changed
SECONDS = 60.0  # of tests for a mutant, at their usual pace
# Beyond ten times its usual time a test may take so much longer [s], and where kernels compile.
PATIENCE, COMPILING = 60.0, 300.0


class Tree:
    """A copy of the working tree, with a cache of its own, in which tests run."""

    def __init__(self, number):
        self.folder, self.cache = BUILD / f"tree-{number}", BUILD / f"cache-{number}"
        shutil.rmtree(self.folder, ignore_errors=True)
        listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
        for name in subprocess.check_output(listed, cwd=ROOT, text=True).splitlines():
            if (ROOT / name).is_file():  # (not deleted)
                (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, self.folder / name)
        self.src, self.log = self.folder / "src", self.folder / "build/log"
        self.log.parent.mkdir()
        # child processes of tests are watched too
        start = "import watch_tests\nif watch_tests.CALLS:\n    watch_tests.trace()\n"
        (self.src / "sitecustomize.py").write_text(start)

    def pytest(self, files, **settings):
        """Run test files until one test fails: (whether none did, the plugin's log)."""
        self.log.write_text("")
        path = f"{self.src}{os.pathsep}{self.folder / 'tools'}"
        environment = os.environ | {"PYTHONPATH": path, "XDG_CACHE_HOME": str(self.cache)}
        environment |= {"WATCH_LOG": str(self.log), "WATCH_SOURCES": str(self.src)} | settings
        command = [sys.executable, "-m", "pytest", "-p", "watch_tests", *files]
        with (self.folder / "build/output").open("w") as output:
            process = subprocess.Popen(
                command, cwd=self.folder, env=environment, stdout=output, stderr=output,
                start_new_session=True,
            )  # fmt: skip
            try:
                passed = process.wait() == 0
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
        return passed, [line.split("\t") for line in self.log.read_text().splitlines()]

    def gather(self, file):
        """Which functions the tests of a file call, and how long each takes."""
        kept = BUILD / "calls" / f"{Path(file).stem}-{digest(self.folder / file)}.json"
        if kept.exists():
            return json.loads(kept.read_text())
        calls, kernels = self.folder / "build/calls", -1
        while kernels < (kernels := len(list(self.cache.rglob("*.nbc")))):  # some were compiled
            calls.write_text("")
            passed, log = self.pytest([file], WATCH_CALLS=str(calls))
        if not log and not passed:
            print(f"{file} cannot be run, see {self.folder / 'build/output'}", flush=True)
        seconds, functions = defaultdict(float), defaultdict(set)
        for _, test, *took in log:
            seconds[test] += float(*took or [0])
        for what, test, *_ in log:
            if what.endswith(("failed", "skipped")):
                seconds.pop(test, None)
        for text in calls.read_text().splitlines():
            test, function = text.split("\t")
            functions[test].add(function)
        answer = {"seconds": seconds, "functions": {t: sorted(f) for t, f in functions.items()}}
        kept.parent.mkdir(exist_ok=True)
        kept.write_text(json.dumps(answer))
        return answer

    def attempt(self, mutant, tests):
        """What kills a mutant: a test's name and how, or None."""
        path, kernels = self.src / mutant["file"], mutant["file"].startswith(KERNELS)
        limits = self.folder / "build/limits"
        patience = PATIENCE + COMPILING * kernels
        limits.write_text(json.dumps({test: 10 * s + patience for test, s in tests.items()}))
        before, caches = path.read_bytes(), set(self.cache.glob("ratestate/*"))
        site = mutant["start"], mutant["end"]
        path.write_bytes(before[: site[0]] + mutant["new"].encode() + before[site[1] :])
        os.utime(path, (mutant["number"], mutant["number"]))  # no stale bytecode
        files = list(dict.fromkeys(test.split("::")[0] for test in tests))
        try:
            passed, log = self.pytest(files, WATCH_LIMITS=str(limits))
        finally:
            path.write_bytes(before)
            for folder in set(self.cache.glob("ratestate/*")) - caches:
                shutil.rmtree(folder)
        failed = [test for what, test, *_ in log if what.endswith("failed")]
        if passed or failed:
            return None if passed else failed[0]
        return f"{log[-1][1]} (hung or crashed)" if log else "no test can be collected"


def draw(seed):
    """All mutants in an order drawn by a seed."""
    rng, found = random.Random(seed), []
    for path in sorted((ROOT / "src/ratestate").rglob("*.py")):
        source, file = path.read_bytes(), str(path.relative_to(ROOT / "src"))
        for site in mutations.sites(source):
            old = source[site.start : site.end].decode()
            found.append({"file": file, "old": old, **site._asdict()})
    rng.shuffle(found)
    return [
        mutant | {"number": i, "new": rng.choice(mutant.pop("options"))}
        for i, mutant in enumerate(found, 1)
    ]


class Parts:
    """The tests of each part of the sources."""

    def __init__(self, gathered):
        self.seconds, self.callers, self.named = {}, defaultdict(set), defaultdict(set)
        for file, answer in gathered.items():
            self.seconds |= answer["seconds"]
            for test, functions in answer["functions"].items():
                for function in functions:
                    self.callers[function].add(test or f"{file}::")  # at the file's top
        for folder in ("src", "tests"):
            for path in sorted((ROOT / folder).rglob("*.py")):
                file = str(path.relative_to(ROOT)).removeprefix("src/")
                for part, words in mutations.mentions(path.read_bytes()).items():
                    for word in words:
                        self.named[word].add((file, part))

    def tests(self, file, part, seen=frozenset()):
        """The tests that call a part; where none can be seen to, those of all that name it."""
        found = set()
        for name in part:
            here = f"{file}::{name}"
            found |= {test for test in self.seconds if test.split("[")[0] == here}
            found |= self.callers.get(f"{file}:{name}", set())
        if not found or file.startswith(KERNELS):
            for name in part:
                for user in self.named[name.rsplit(".", 1)[-1]] - seen:
                    found |= self.tests(*user, seen | {user})
        return found

    def chosen(self, mutant):
        """Quickest first: the tests of a mutant's part, and the rest of their files, which may see
        what a shared fixture or a file's top called; so many as SECONDS allow.
        """
        found = self.tests(mutant["file"], mutant["part"])
        files = {test.split("::")[0] for test in found}
        beside = [test for test in self.seconds if test.split("::")[0] in files]
        total, tests = 0.0, {}
        for test in sorted(beside, key=lambda test: (test not in found, self.seconds[test])):
            total += self.seconds[test]
            if total > SECONDS and tests:
                break
            tests[test] = self.seconds[test]
        return tests


def digest(*paths):
    """A hash of files."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in sorted(paths))).hexdigest()[:16]


def line(mutant):
    """What a mutant is, and what became of it."""
    change = f"{mutant['old']} -> {mutant['new']}".replace("\n", " ")
    fate = f"killed by {mutant['killer']}" if mutant["killer"] else "SURVIVED"
    return f"{mutant['number']:4} {mutant['file']}:{mutant['line']}: {change}: {fate}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--count", type=int, default=100, help="mutants to draw")
    parser.add_argument("--seed", type=int, default=13, help="of the draw")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of mutants to look at")
    options = parser.parse_args()

    BUILD.mkdir(parents=True, exist_ok=True)
    trees = queue.SimpleQueue()
    for number in range(options.jobs):
        trees.put(Tree(number))

    def borrow(do, *given):
        tree = trees.get()
        try:
            return do(tree, *given)
        finally:
            trees.put(tree)

    files = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "tests").rglob("test_*.py"))
    with ThreadPoolExecutor(options.jobs) as pool:
        answers = pool.map(lambda file: borrow(Tree.gather, file), files)
        parts = Parts(dict(zip(files, answers, strict=True)))

    source = digest(*(ROOT / "src").rglob("*.py"))
    tests = digest(*(ROOT / "tests").rglob("*.py"))
    done = {}
    for text in RESULTS.read_text().splitlines() if RESULTS.exists() else []:
        kept = json.loads(text)
        if kept["source"] == source and (kept["killer"] or kept["tests"] == tests):
            done[kept["seed"], kept["number"]] = kept["killer"]

    def attempt(mutant):
        key = options.seed, mutant["number"]
        if key not in done:
            chosen = parts.chosen(mutant)
            mutant["killer"] = borrow(Tree.attempt, mutant, chosen) if chosen else None
            record = {"seed": options.seed, "source": source, "tests": tests, **mutant}
            with RESULTS.open("a") as results:
                results.write(json.dumps(record) + "\n")
        else:
            mutant["killer"] = done[key]
        print(line(mutant), flush=True)
        return bool(mutant["killer"])

    mutants = draw(options.seed)[: options.count]
    if options.only:
        mutants = [mutant for mutant in mutants if mutant["number"] in options.only]
    with ThreadPoolExecutor(options.jobs) as pool:
        killed = sum(pool.map(attempt, mutants))
    print(f"{killed} of {len(mutants)} killed (seed {options.seed}, sources {source})")


if __name__ == "__main__":
    main()
