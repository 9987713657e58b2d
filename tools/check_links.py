"""Whether everything that pages refer to is there: python tools/check_links.py build/docs/html

Follows each link and picture of each page to a file, and to the place in it; nothing beyond this
machine is asked for.  Pictures must say in words what they show.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The places of a page, what it refers to, and the pictures without words."""

    def __init__(self, path):
        super().__init__()
        self.places, self.targets, self.wordless = {""}, set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.places |= {given[key] for key in ("id", "name") if given.get(key)}
        targets = [given.get("href"), given.get("src")]
        targets += [part.split()[0] for part in given.get("srcset", "").split(",") if part.strip()]
        self.targets |= {target for target in targets if target}
        # (a thumbnail has its words beside it)
        wordless = tag == "img" and not (given.get("alt") or "").strip()
        if wordless and "_thumb." not in given.get("src", ""):
            self.wordless.append(given.get("src"))


def problems(site):
    """What is wrong with the pages under a folder, a line each."""
    files = [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]
    pages = {path: Page(path) for path in files}
    if not pages:
        yield f"{site} holds no page"
    for path, page in pages.items():
        here = path.relative_to(site)
        yield from (f"{here}: picture {source} has no words" for source in page.wordless)
        for target in sorted(page.targets):
            url = urlsplit(target)
            if url.scheme or url.netloc:
                continue
            there = (path.parent / unquote(url.path)).resolve() if url.path else path
            there = there / "index.html" if there.is_dir() else there
            if not there.is_file():
                yield f"{here}: {target} is not there"
            elif there in pages and unquote(url.fragment) not in pages[there].places:
                yield f"{here}: {target} has no such place"


def main():
    site = Path(sys.argv[1]).resolve()
    found = list(problems(site))
    for line in found:
        sys.stderr.write(f"{line}\n")
    sys.stdout.write(f"{site}: {len(found)} problems\n")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
