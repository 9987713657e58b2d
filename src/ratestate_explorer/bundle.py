"""Combine the page's files into a few, to serve, or into one HTML text, to save.

A browser asks for modules one after another as it reads what they import, and loads none from files
on the disk.  So each module becomes a function of one script, called once, after those that it
imports; it returns its exports.
"""

import base64
import hashlib
import posixpath
import re
from html import escape
from pathlib import Path

STATIC = Path(__file__).with_name("static")
_IMPORT = re.compile(r'^import (?:\{([^}]*)\}|(\w+)) from "([^"]+)";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) ([\w$]+))", re.MULTILINE)
# Comments may hold code of any kind.
_COMMENT = re.compile(r"^/\*.*?\*/\n", re.MULTILINE | re.DOTALL)
_DEFAULT = re.compile(r"^export \{ (\w+) as default \};\n", re.MULTILINE)
# What the others do not understand, such as dynamic imports and exports that change.
_LEFT = re.compile(r"^(?:import|export)\b.*|\bimport[(.].*", re.MULTILINE)
_STYLE = re.compile(r'<link rel="stylesheet" href="([^"]+)">\n?')
_ICON = re.compile(r'<link rel="icon" href="([^"]+)" type="([^"]+)">')
_MAIN = re.compile(r'<script type="module" src="([^"]+)"></script>')
_SAVED = '<p id="saved" hidden></p>'
_TITLE = "<title>ratestate explorer</title>"


def bundle(title, line, recording):
    """Return the page as one HTML text, with a line that says that it is saved.

    title : plain text
    line : HTML
    recording : JSON text that js/server/recording.js plays
    """
    page, style, code = _parts()
    data = recording.replace("<", r"\u003c")
    policy = (
        f"default-src 'none'; script-src {_hash(code)}; style-src {_hash(style)}; "
        f"img-src data:; base-uri 'none'; form-action 'none'"
    )
    head = f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
    page = _STYLE.sub("", page)
    page = _ICON.sub(lambda m: f'<link rel="icon" href="{_data(m[1], m[2])}">', page)
    script = (
        f'<script type="application/json" id="recording">{data}</script>\n'
        f'<script type="module">{code}</script>'
    )
    page = _MAIN.sub(lambda _: f"<style>{style}</style>\n{script}", page)
    page = page.replace(_TITLE, f"{head}<title>{escape(title)}</title>")
    return page.replace(_SAVED, f'<p id="saved">{line}</p>')


def served():
    """Return path -> (text, type) of the page, its style and its script."""
    page, style, code = _parts()
    page = _STYLE.sub("", page)
    links = '<link rel="stylesheet" href="page.css">\n<script type="module" src="page.js"></script>'
    return {
        "/": (_MAIN.sub(links, page), "text/html"),
        "/page.css": (style, "text/css"),
        "/page.js": (code, "text/javascript"),
    }


def _parts():
    """Return the text of the page as written; its styles and its modules as one text each."""
    page = (STATIC / "index.html").read_text(encoding="utf-8")
    style = "".join(_text(path) for path in _STYLE.findall(page))
    (main,) = _MAIN.findall(page)
    return page, style, _script(main)


def _script(main):
    """Return a module and all modules that it needs as one script."""
    names: dict[str, str] = {}
    functions: list[str] = []

    def add(path):
        """Add a module after those that it imports; the name of its exports."""
        if path not in names:
            text = _COMMENT.sub(lambda m: m[0] if "Copyright" in m[0] else "", _text(path))
            for *_, other in _IMPORT.findall(text):
                add(_sibling(path, other))
            names[path] = f"module{len(names)}"
            functions.append(f"const {names[path]} = (() => {{\n{_function(path, text)}}})();\n")
        return names[path]

    def _function(path, text):
        exports = [*_EXPORT.findall(text), *(f"default: {x}" for x in _DEFAULT.findall(text))]

        def replacement(found):
            named, default, other = found.groups()
            names_text = named.replace(" as ", ": ") if named else f" default: {default} "
            return f"const {{{names_text}}} = {names[_sibling(path, other)]};\n"

        text = _DEFAULT.sub("", _EXPORT.sub("", _IMPORT.sub(replacement, text)))
        if left := _LEFT.search(text):
            raise ValueError(f"{path}: {left[0]!r} cannot be put into one file")
        return f"{text}return {{ {', '.join(exports)} }};\n"

    add(main)
    return "".join(functions)


def _sibling(path, other):
    return posixpath.normpath(posixpath.join(posixpath.dirname(path), other))


def _text(path):
    """Return a file of the page; ValueError if it would end the element that it is put into."""
    text = (STATIC / path).read_text(encoding="utf-8")
    if "</" in text and re.search("</(script|style)", text, re.IGNORECASE):
        raise ValueError(f"{path} has the end of an element in it")
    return text


def _data(path, of_type):
    return f"data:{of_type};base64,{base64.b64encode((STATIC / path).read_bytes()).decode()}"


def _hash(text):
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
