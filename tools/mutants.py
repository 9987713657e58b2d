"""What share of random mutants the tests kill: python tools/mutants.py --count 100 --seed 13

Draws mutants of all sites in src/ratestate (mutations.py), each site as likely as any other, and
for each runs in a copy of the tree the tests of that part, the nearest files first (near_tests.py),
until one fails or their time is over.  A test that hangs has killed its mutant too.

Results are kept in build/mutants/results.jsonl, and a run goes on where the last one stopped; a
survivor is tried again once tests have changed.
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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mutations
from near_tests import nearest_first

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build/mutants"
RESULTS = BUILD / "results.jsonl"
KERNELS = ("src/ratestate/engine/", "src/ratestate/friction/built_in_laws.py")  # compile anew
# Processor time that tests of a mutant may take, and time that one test may [s]; more of both where
# kernels compile.
SECONDS, PATIENCE, COMPILING = 90.0, 300.0, 180.0
FILES = 8  # of tests


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

    def killer(self, mutant, tests):
        """What kills a mutant: the name of a test, and how if it did not fail; or None."""
        path, more = self.folder / mutant["file"], COMPILING * mutant["file"].startswith(KERNELS)
        before, caches = path.read_bytes(), set(self.cache.glob("ratestate/*"))
        new = mutant["new"].encode()
        path.write_bytes(before[: mutant["start"]] + new + before[mutant["end"] :])
        os.utime(path, (mutant["number"], mutant["number"]))  # bytecode of no other mutant fits
        try:
            passed, log = self._run(tests, SECONDS + more, PATIENCE + more)
        finally:
            path.write_bytes(before)
            for folder in set(self.cache.glob("ratestate/*")) - caches:
                shutil.rmtree(folder)
        if passed:
            return None
        failed = [test for outcome, test in log if outcome == "failed"]
        return failed[0] if failed else f"{log[-1][1]}, which hung or crashed" if log else "import"

    def _run(self, tests, seconds, patience):
        """Run test files until a test fails: (whether none did, what the plugin has logged)."""
        log = self.folder / "build/log"
        log.parent.mkdir(exist_ok=True)
        log.write_text("")
        environment = os.environ | {
            "PYTHONPATH": f"{self.folder / 'src'}{os.pathsep}{self.folder / 'tools'}",
            "XDG_CACHE_HOME": str(self.cache),
            "WATCH_LOG": str(log),
            "WATCH_SECONDS": str(seconds),
            "WATCH_PATIENCE": str(patience),
        }
        with (self.folder / "build/output").open("w") as output:
            process = subprocess.Popen(
                [sys.executable, "-m", "pytest", "-x", "-p", "watch_tests", *tests],
                cwd=self.folder,
                env=environment,
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
            try:
                passed = process.wait() == 0
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)  # its child processes too
        return passed, [line.split("\t") for line in log.read_text().splitlines()]


def draw(seed):
    """All mutants, in an order drawn by a seed."""
    rng, found = random.Random(seed), []
    for path in sorted((ROOT / "src/ratestate").rglob("*.py")):
        source = path.read_bytes()
        for site in mutations.sites(source):
            old = source[site.start : site.end].decode()
            found.append({"file": str(path.relative_to(ROOT)), "old": old, **site._asdict()})
    rng.shuffle(found)
    return [
        mutant | {"number": number, "new": rng.choice(mutant.pop("options"))}
        for number, mutant in enumerate(found, 1)
    ]


def line(mutant, killer):
    """What a mutant is, and what became of it."""
    change = f"{mutant['old']} -> {mutant['new'] or 'nothing'}".replace("\n", " ")
    fate = f"killed by {killer}" if killer else "SURVIVED"
    return f"{mutant['number']:4} {mutant['file']}:{mutant['line']}: {change}: {fate}"


def digest(folder):
    """A hash of the Python files of a folder."""
    paths = sorted((ROOT / folder).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--count", type=int, default=100, help="mutants to draw")
    parser.add_argument("--seed", type=int, default=13, help="of the draw")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    options = parser.parse_args()

    BUILD.mkdir(parents=True, exist_ok=True)
    source, tests, near = digest("src"), digest("tests"), nearest_first(ROOT)
    known = {}
    for text in RESULTS.read_text().splitlines() if RESULTS.exists() else []:
        kept = json.loads(text)
        if kept["source"] == source and (kept["killer"] or kept["tests"] == tests):
            known[kept["seed"], kept["number"]] = kept["killer"]
    trees = queue.SimpleQueue()
    for number in range(options.jobs):
        trees.put(Tree(number))

    def attempt(mutant):
        key = options.seed, mutant["number"]
        if key not in known:
            tree = trees.get()
            try:
                known[key] = tree.killer(mutant, near[mutant["file"]][:FILES])
            finally:
                trees.put(tree)
            record = {"seed": options.seed, "source": source, "tests": tests, "killer": known[key]}
            with RESULTS.open("a") as results:
                results.write(json.dumps(mutant | record) + "\n")
        print(line(mutant, known[key]), flush=True)
        return bool(known[key])

    with ThreadPoolExecutor(options.jobs) as pool:
        fates = list(pool.map(attempt, draw(options.seed)[: options.count]))
    print(f"{sum(fates)} of {len(fates)} killed (seed {options.seed}, sources {source})")


if __name__ == "__main__":
    main()
