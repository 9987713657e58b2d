"""`make torture`: a sweep is killed again and again, and must end as if nothing had happened.

``kill -9`` falls on ``ratestate sweep`` at random moments: before the store exists, while it is
made, while chunks are solved and written.  The same command then resumes, and may be killed too.
After each kill the store is held against that of an uninterrupted run, file by file, byte by byte.
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import xarray
from rich.console import Console

CONSOLE = Console(highlight=False)
COMMAND = [sys.executable, "-c", "from ratestate.interfaces.cli import main; main()", "sweep"]
# Without mass, and soft enough, no quasi-static cycle exists: those cases fail.
SCENARIO = """
[slider]
a = 0.003
b = 0.006
sigma = "2 MPa"
[sweep]
function = "{function}"
M = {masses}
Dc = ["10 um", "15 um"]
K = {{ from = "0.1 GPa/m", to = "1.2 GPa/m", n = {stiffnesses}, scale = "log" }}
V_lp = {{ from = "0.1 mm/s", to = "0.3 m/s", n = {speeds}, scale = "log" }}
"""
SOME_FAILED = 3  # exit code
PATIENCE = 300.0  # seconds
# What a kill may leave, as `Victim.check` says it.
TRACES = ("no store yet", "half a store", "half written", "cut off")


class Size(NamedTuple):
    """What the sweep is, and how big; a chunk is half of the speeds."""

    function: str = "limit_cycle"
    masses: tuple = (0, 100, 1000, 3000, 10000)
    stiffnesses: int = 4
    speeds: int = 50

    @property
    def scenario(self):
        return SCENARIO.format(**self._asdict() | {"masses": list(self.masses)})

    @property
    def chunk(self):
        return self.speeds // 2

    @property
    def code(self):
        """The exit code: some cycles without mass fail, all else is well."""
        return SOME_FAILED if self.function == "limit_cycle" else 0


# (without kernels to load, a process takes a second)
SMALL = Size(function="stability", masses=(1000,), stiffnesses=2, speeds=4)


def command(folder, size):
    """The command that makes the store in a folder or resumes it."""
    options = ["--store", folder / "x.zarr", "--chunk", size.chunk]
    return [str(word) for word in (*COMMAND, folder / "sweep.toml", *options)]


class Run:
    """The command, in a process group of its own, that makes a store or resumes it."""

    def __init__(self, folder, size):
        self.store = folder / "x.zarr"
        self.begin = time.monotonic()
        self.errors = folder / "errors"
        with self.errors.open("w") as errors:
            self.process = subprocess.Popen(
                command(folder, size),
                stdout=subprocess.DEVNULL,
                stderr=errors,
                start_new_session=True,
            )

    @property
    def age(self):
        return time.monotonic() - self.begin

    def until(self, condition):
        """Wait until this is so, or the process has ended; whether it still runs."""
        while not condition():
            if self.process.poll() is not None or self.age > PATIENCE:
                return False
            time.sleep(0.0005)
        return self.process.poll() is None

    def kill(self):
        """Kill it; whether it was still there to be killed."""
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        return self.process.wait() == -signal.SIGKILL

    def end(self):
        """Wait for its end; exit code, and what it wrote to stderr."""
        return self.process.wait(PATIENCE), self.errors.read_text()


class Here(Run):
    """The same in this process, from beginning to end: quicker, and nothing that can be killed."""

    def __init__(self, folder, size):
        from typer.testing import CliRunner

        from ratestate.interfaces.cli import main

        self.store, self.begin = folder / "x.zarr", time.monotonic()
        self.result = CliRunner().invoke(main, command(folder, size)[len(COMMAND) - 1 :])

    def until(self, condition):
        return False

    def end(self):
        return self.result.exit_code, self.result.stderr


class Timing(NamedTuple):
    """When an uninterrupted run, begun at 0 s, begins and has made its store, and ends."""

    making: float
    made: float
    end: float


def siblings(store):
    """What stands beside a store and is its own."""
    return [path for path in store.parent.iterdir() if path.name.startswith(f".{store.name}")]


def files_in_sibling(store):
    """Number of files in a store that is being made; -1 before that."""
    numbers = [sum(len(files) for *_, files in os.walk(path)) for path in siblings(store)]
    return max(numbers, default=-1)


def chunks_done(store):
    """Blocks, such as "0/1", of the statuses in a store: those of the chunks that are done."""
    folder = store / "status/c"
    found = (one.relative_to(folder) for one in folder.rglob("*") if one.is_file())
    return {str(block) for block in found if block.suffix != ".partial"}


def contents(store):
    """Path inside a store -> bytes, of all its files."""
    found = (path for path in store.rglob("*") if path.is_file())
    return {str(path.relative_to(store)): path.read_bytes() for path in found}


class Reference:
    """The store of an uninterrupted run, and how long that took."""

    def __init__(self, folder, size, whole=Run):
        folder.mkdir()
        (folder / "sweep.toml").write_text(size.scenario)
        run, self.whole = whole(folder, size), whole
        run.until(lambda: siblings(run.store))
        making = run.age
        run.until(run.store.exists)
        made = run.age
        code, errors = run.end()
        assert code == size.code, f"the uninterrupted run ended with {code}: {errors}"
        self.timing = Timing(making, made, run.age)
        self.files = contents(run.store)
        with xarray.open_zarr(run.store, chunks=None) as data:
            self.arrays = {name: values.values for name, values in data.variables.items()}
            self.status = Counter(data.status.values.ravel().tolist())
        self.chunks = chunks_done(run.store)
        self.of_chunk = self._files_of_chunks()
        # files of a store in which nothing is done yet
        self.to_begin_with = len(self.files) - sum(map(len, self.of_chunk.values()))

    def _files_of_chunks(self):
        """Block of a chunk -> its files, such as V_max/c/0/1 or multipliers/c/0/1/0."""
        return {
            block: {name for name in self.files if f"{name}/".find(f"/c/{block}/") > 0}
            for block in self.chunks
        }


class Victim:
    """A store whose sweep is killed, and what is found wrong with it."""

    def __init__(self, folder, size, reference):
        folder.mkdir()
        (folder / "sweep.toml").write_text(size.scenario)
        self.folder, self.size, self.reference = folder, size, reference
        self.store = folder / "x.zarr"
        self.stamps: dict = {}  # file of a chunk that is done -> when and where written
        self.wrong: list = []
        self.kills = 0

    def check(self):
        """Hold what is there against the uninterrupted run's; what the last kill left, in words."""
        files = contents(self.store)
        partial = [name for name in files if name.endswith(".partial")]
        whole = {name: content for name, content in files.items() if name not in partial}
        expected = self.reference.files
        for name, content in whole.items():
            if content != expected.get(name):
                known = "differs from" if name in expected else "is unknown to"
                self.wrong.append(f"{name} {known} the uninterrupted run")
        done = chunks_done(self.store)
        for i in done:
            for name in sorted(self.reference.of_chunk[i] - whole.keys()):
                self.wrong.append(f"chunk {i} is said to be done but lacks {name}")
        for name, stamp in self.stamps.items():
            if self._stamp(name) != stamp:
                self.wrong.append(f"{name} was done before, and was written again")
        kept = set().union(*(self.reference.of_chunk[i] for i in done))
        self.stamps = {name: self._stamp(name) for name in kept & whole.keys()}
        if not self.store.exists():
            return "half a store" if siblings(self.store) else "no store yet"
        torn = [
            i for i in self.reference.chunks - done if self.reference.of_chunk[i] & whole.keys()
        ]
        words = f"{len(done)} of {len(self.reference.chunks)} chunks"
        words += f", {len(torn)} half written" if torn else ""
        return words + (f", {len(partial)} files cut off" if partial else "")

    def _stamp(self, name):
        try:
            found = (self.store / name).stat()
        except FileNotFoundError:
            return None
        return found.st_mtime_ns, found.st_ino

    def strike(self, dice):
        """Run the command and kill it at a moment that the dice choose; what was aimed at."""
        run, timing = Run(self.folder, self.size), self.reference.timing
        left = sorted(
            self.reference.chunks - chunks_done(self.store),
            key=lambda block: [*map(int, block.split("/"))],
        )
        made = self.store.exists()
        aim = dice.choice(["any moment", "a chunk", "a chunk" if made else "creation"])
        if aim == "creation":
            number = dice.randrange(self.reference.to_begin_with)
            run.until(lambda: self.store.exists() or files_in_sibling(self.store) >= number)
        elif aim == "a chunk" and left:
            chunk = dice.choice(left[: 1 + len(left) // 2])
            file = dice.choice(sorted(self.reference.of_chunk[chunk]))
            run.until(lambda: (self.store / file).exists())
        else:
            done = 1.0 - len(left) / len(self.reference.chunks)
            moment = dice.uniform(0.0, timing.end - done * (timing.end - timing.made))
            run.until(lambda: run.age >= moment)
        if run.kill():
            self.kills += 1
            return aim
        return ""

    def finish(self):
        """Let the command end, and see whether all is as in the uninterrupted run."""
        code, errors = self.reference.whole(self.folder, self.size).end()
        if code != self.size.code:
            self.wrong.append(f"the resuming command ended with {code}: {errors}")
        self.check()
        if missing := self.reference.files.keys() - contents(self.store).keys():
            self.wrong.append(f"missing in the end: {', '.join(sorted(missing))}")
        beside = {path.name for path in self.folder.iterdir()} - {"x.zarr", "sweep.toml", "errors"}
        if beside:
            self.wrong.append(f"left beside the store: {', '.join(sorted(beside))}")
        with xarray.open_zarr(self.store, chunks=None) as data:
            for name, values in self.reference.arrays.items():
                if not same(data[name].values, values):
                    self.wrong.append(f"{name} differs from the uninterrupted run")


def same(one, other):
    """Whether two arrays are equal to the last bit; text is no plain array, and compares so."""
    if one.dtype.kind in "OT" or other.dtype.kind in "OT":
        return one.tolist() == other.tolist()
    return (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())


def torture(folder, size, kills, seed, say=lambda text: None, whole=Run):
    """Kill sweeps of this size so many times; `Counter` of what the kills left, list of faults.

    whole : makes the runs that are not killed
    """
    dice = random.Random(seed)
    reference = Reference(folder / "reference", size, whole)
    timing = reference.timing
    say(
        f"uninterrupted: {sum(reference.status.values())} cases in {len(reference.chunks)} chunks, "
        f"statuses {dict(reference.status)}; its store is made from {timing.making:.2f} s to "
        f"{timing.made:.2f} s, all done at {timing.end:.2f} s"
    )
    left, wrong, number, rounds = Counter(), [], 0, 0
    while number < kills:
        rounds += 1
        victim = Victim(folder / f"round {rounds}", size, reference)
        for _ in range(min(dice.randrange(3, 8), kills - number)):
            aim = victim.strike(dice)
            found = victim.check()
            if not aim:
                break  # it was done before the blow fell
            number += 1
            left.update(trace for trace in TRACES if trace in found)
            say(f"kill {number} of {kills}, aimed at {aim}: {found}")
        victim.finish()
        say(f"round {rounds} resumed to the end after {victim.kills} kills")
        for fault in victim.wrong:
            say(f"  WRONG: {fault}")
        wrong += [f"round {rounds}: {fault}" for fault in victim.wrong]
        shutil.rmtree(victim.folder)
    return left, wrong


def main():
    parser = argparse.ArgumentParser(description="Kill a sweep again and again, and look for harm.")
    parser.add_argument("--kills", type=int, default=30, help="how many; 30 by default")
    parser.add_argument("--seed", type=int, default=0, help="of their moments")
    options = parser.parse_args()
    begin = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="ratestate-torture-") as folder:
        left, wrong = torture(Path(folder), Size(), options.kills, options.seed, CONSOLE.print)
    traces = ", ".join(f"{left[trace]} {trace}" for trace in TRACES)
    CONSOLE.print(f"{options.kills} kills left: {traces} ({time.monotonic() - begin:.0f} s)")
    if wrong:
        CONSOLE.print(f"[red]{len(wrong)} faults[/red], --seed {options.seed}")
        sys.exit(1)
    CONSOLE.print("every case is there in the end, and every bit as in the uninterrupted run")


if __name__ == "__main__":
    main()
