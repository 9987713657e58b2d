"""Make what a release publishes, and try it: python tools/make_dist.py [--tag v1.2.3]

Into dist/: the source distribution and the wheel, SHA256SUMS, RELEASE_NOTES.md from the changelog,
and recipe.yaml, the conda recipe with the address and checksum of the source distribution.  Both
archives are built twice, must be the same to the last byte, and are tried as tools/try_wheel.py
does.  With a tag it must be that of the version, and the changelog must have the version's section.
"""

import argparse
import hashlib
import re
import shutil
import sys
import tempfile
import tomllib
from pathlib import Path

from try_wheel import ROOT, Failed, build, say, try_archives

DIST = ROOT / "dist"
PYPI = "https://pypi.org/packages/source/r/ratestate"


def main():
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--tag", help="the tag of a release, such as v1.2.3")
    tag = options.parse_args().tag
    try:
        make(tag)
    except Failed as error:
        sys.exit(f"error: {error}")


def make(tag):
    """Fill dist/ anew."""
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    if tag not in (None, f"v{version}"):
        raise Failed(f"the tag {tag} is not v{version}, the version of pyproject.toml")
    notes = release_notes((ROOT / "CHANGELOG.md").read_text(), version, is_release=bool(tag))
    recipe = (ROOT / "conda" / "recipe" / "recipe.yaml").read_text()
    shutil.rmtree(DIST, ignore_errors=True)
    sums = sums_of(build(DIST))
    with tempfile.TemporaryDirectory() as folder:
        if sums_of(build(Path(folder))) != sums:
            raise Failed("two builds of the same files differ")
    try_archives(DIST)
    (DIST / "SHA256SUMS").write_text("".join(f"{sums[name]}  {name}\n" for name in sums))
    (DIST / "RELEASE_NOTES.md").write_text(notes)
    sdist = next(name for name in sums if name.endswith(".tar.gz"))
    (DIST / "recipe.yaml").write_text(published(recipe, sdist, sums[sdist]))
    say(f"{DIST.name}/: {', '.join(sorted(path.name for path in DIST.glob('[!.]*')))}")


def sums_of(archives):
    """Name -> SHA-256 of files."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(archives)}


def release_notes(changelog, version, *, is_release):
    """The changelog's section of the version; of a build that is no release, Unreleased if there.

    Raises Failed where there is none.
    """
    sections = re.split(r"^## \[(.+?)\].*\n", changelog, flags=re.MULTILINE)
    texts = dict(zip(sections[1::2], map(str.strip, sections[2::2]), strict=True))
    names = [version] if is_release else ["Unreleased", version]
    for name in names:
        if texts.get(name):
            return f"# ratestate {version}\n\n{texts[name]}\n"
    raise Failed(f"CHANGELOG.md has no section {' or '.join(names)}")


def published(recipe, sdist, checksum):
    """The conda recipe, whose source is the archive of dist/, with the published one in its place.

    Raises Failed where the recipe has no such source.
    """
    source = re.compile(r"^source:\n  path: \S.*\n", re.MULTILINE)
    address = f"source:\n  url: {PYPI}/{sdist}\n  sha256: {checksum}\n"
    recipe, count = source.subn(address, recipe)
    if count != 1:
        raise Failed("conda/recipe/recipe.yaml has no source that is a path")
    return recipe


if __name__ == "__main__":
    main()
