"""Build the wheel and the source distribution, install each into an empty environment, and use it.

    python tools/try_wheel.py

The wheel is built from the source distribution.  Beside each come the dependencies that its own
metadata names, in the versions of requirements.lock, and nothing else; it is used in a folder
outside of this one, first without extras and then with the extra `explorer`.  git tells which files
belong to the package; uv builds and installs.
"""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import urllib.request
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements.lock"
BUILD = ROOT / "tools" / "build.lock"

IMPORT_ALL = """
import importlib, pkgutil, ratestate
names = [module.name for module in pkgutil.walk_packages(ratestate.__path__, "ratestate.")]
for name in names:
    importlib.import_module(name)
print(len(names))
"""

READ = """
import sys, numpy, ratestate.files
found = ratestate.files.read(sys.argv[1])
assert found.sizes["time"] > 100, found.sizes
for name in ("V", "theta", "tau"):
    assert numpy.isfinite(found[name]).all(), name
print(found.sizes["time"])
"""


class Failed(Exception):
    """What is wrong with the wheel."""


def main():
    try:
        with tempfile.TemporaryDirectory(prefix="ratestate-wheel-") as folder:
            build(Path(folder))
            try_archives(Path(folder))
    except Failed as error:
        sys.exit(f"error: {error}")


def build(folder):
    """Build both archives into this folder, and return their paths: wheel and sdist."""
    tool("uv", "build", "--out-dir", folder, "--build-constraint", BUILD, "--require-hashes", ROOT)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    return wheel, sdist


def try_archives(folder):
    """Look into, install and use the archives of this folder."""
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    holds_the_package(wheel)
    holds_the_project(sdist)
    for archive in (wheel, sdist):
        say(f"{archive.name}, in an empty environment:")
        with tempfile.TemporaryDirectory(prefix="ratestate-env-") as place:
            home = Path(place) / "env"
            tool("uv", "venv", "--python", sys.executable, home)
            how = ("--constraint", LOCK, "--build-constraint", BUILD)
            install = ("uv", "pip", "install", "--python", home, *how)
            tool(*install, archive)
            works(home / "bin", Path(place), version=wheel.name.split("-")[1])
            needs_the_extra(home / "bin/ratestate", Path(place))
            tool(*install, f"ratestate[explorer] @ {archive.as_uri()}")
            page = explored(home / "bin/ratestate", Path(place))
            say(f"ratestate explore: a page of {page} bytes")


# Inside -------------------------------------------------------------------------------------------


def holds_the_package(wheel):
    """The wheel holds the files of src, all that is told about it, and nothing else."""
    with zipfile.ZipFile(wheel) as archive:
        found = set(archive.namelist())
    about = {name for name in found if name.split("/")[0].endswith(".dist-info")}
    compare(wheel, found - about, {name.removeprefix("src/") for name in tracked("src")})
    told = {name.partition("/")[2] for name in about}
    compare(wheel, told, {"METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE"})
    say(f"{wheel.name}: {len(found)} files, {wheel.stat().st_size / 1e3:.0f} kB")


def holds_the_project(sdist):
    """The source distribution holds the project's files."""
    with tarfile.open(sdist) as archive:
        found = {member.name.partition("/")[2] for member in archive if member.isfile()}
    compare(sdist, found, tracked() | {"PKG-INFO"})
    say(f"{sdist.name}: {len(found)} files, {sdist.stat().st_size / 1e3:.0f} kB")


def compare(archive, found, expected):
    for names, problem in ((expected - found, "lacks"), (found - expected, "should not hold")):
        if names:
            raise Failed(f"{archive.name} {problem} {', '.join(sorted(names))}")


def tracked(*paths):
    """The project's files under these paths, or all: those that git does not ignore."""
    listing = ["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = tool(*listing, "--", *paths).split("\0")
    return {name for name in names if name and (ROOT / name).is_file()}


# In use -------------------------------------------------------------------------------------------


def works(programs, folder, version):
    """The installed package does its work, from a folder that is not the project's."""
    empty = folder / "elsewhere"
    empty.mkdir()

    def use(program, *arguments):
        return tool(programs / program, *arguments, cwd=empty, env=alone(folder))

    if (told := use("ratestate", "--version").strip()) != version:
        raise Failed(f"ratestate --version says {told}, and the wheel is of {version}")
    say(f"ratestate {told}")
    use("ratestate", "--help")
    modules = use("python", "-I", "-W", "error", "-c", IMPORT_ALL).strip()
    say(f"{modules} modules can be imported")
    for line in use("ratestate", "init", "--list").splitlines():
        use("ratestate", "init", line.split()[0])
    say(f"ratestate init: {len([*empty.glob('*.toml')])} scenario files")
    use("ratestate", "run", "lab.toml", "--out", "lab.nc", "--plot", "lab.png")
    times = use("python", "-I", "-c", READ, "lab.nc").strip()
    say(f"ratestate run lab.toml: {times} times")
    use("ratestate", "fit", "record.txt", "--out", "fitted")
    say("ratestate fit record.txt")


def needs_the_extra(program, folder):
    """The explorer says what to install."""
    command = [program, "explore", "--no-browser"]
    done = subprocess.run(command, env=alone(folder), capture_output=True, text=True, check=False)
    if done.returncode == 0 or "pip install 'ratestate[explorer]'" not in done.stderr:
        raise Failed(f"without its extra, ratestate explore says {done.stderr!r}")
    say("ratestate explore without its extra: it says what to install")


def explored(program, folder):
    """The size of the explorer's page, as its server gives it."""
    command = [program, "explore", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command, cwd=folder, env=alone(folder), stdout=subprocess.PIPE, text=True
    ) as server:
        try:
            told = server.stdout.readline()
            address = re.search(r"http://127\.0\.0\.1:\d+/", told)
            if not address:
                raise Failed(f"ratestate explore says {told!r}, and no address")
            with urllib.request.urlopen(address[0], timeout=60) as page:
                return len(page.read())
        except OSError as error:
            raise Failed(f"the explorer's page is not served: {error}") from error
        finally:
            server.kill()


def alone(folder):
    """The environment without what points to this project, or to its caches."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
    return kept | {"XDG_CACHE_HOME": str(folder / "cache"), "MPLCONFIGDIR": str(folder / "cache")}


# Tools --------------------------------------------------------------------------------------------


def tool(program, *arguments, **how):
    """What a program prints; `uv` is the one beside this Python, if there is one."""
    beside = Path(sys.executable).with_name("uv")
    if program == "uv":
        program = beside if beside.exists() else shutil.which("uv")
        if program is None:
            raise Failed("there is no uv: run `make setup`, or install it")
        arguments = ("--quiet", "--no-config", *arguments)
    command = [str(part) for part in (program, *arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, **how)
    if done.returncode:
        raise Failed(
            f"{' '.join(command)}\nended with {done.returncode}\n{done.stdout}{done.stderr}"
        )
    return done.stdout


def say(line):
    print(line, flush=True)


if __name__ == "__main__":
    main()
