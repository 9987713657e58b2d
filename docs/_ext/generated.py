"""Parts of pages that the code itself writes, so that they cannot go stale.

A page asks for one with a line such as ``<!-- generated: commands -->``.  In pages that are also
read as Markdown the part follows, up to ``<!-- end -->``: ``python docs/_ext/generated.py`` writes
it.
"""

import ast
import inspect
import operator
import re
import subprocess
import sys
from pathlib import Path

import materials
import symbols

DOCS = Path(__file__).parent.parent
MARK = re.compile(
    r"^<!-- generated: (\w+) -->$(?:\n+((?:(?!^<!--).*\n)*)^<!-- end -->$)?", re.MULTILINE
)


def fill(app, docname, source):
    """Put what the code says in the place of each mark; note the page, to be read anew."""
    if MARK.search(source[0]):
        app.env.generated_pages = getattr(app.env, "generated_pages", set()) | {docname}
        source[0] = MARK.sub(lambda mark: WRITERS[mark[1]](), source[0])


def current(text):
    """The text of a page, with each part that it shows as the code says it."""

    def part(mark):
        head = f"<!-- generated: {mark[1]} -->"
        return head if mark[2] is None else f"{head}\n\n{WRITERS[mark[1]]()}\n\n<!-- end -->"

    return MARK.sub(part, text)


def outdated(app, env, added, changed, removed):
    """Pages with generated parts are read each time: their text does not say if they changed."""
    return list(getattr(env, "generated_pages", set()) - removed)


def commands():
    """What typer says of each command of ``ratestate``, examples as code."""
    from ratestate.interfaces.cli.exits import EXIT_CODES

    asked = [
        sys.executable,
        *"-m typer ratestate.interfaces.cli utils docs --name ratestate".split(),
    ]
    text = subprocess.run(asked, check=True, capture_output=True, text=True).stdout
    text = text.partition("\n")[2].replace(EXIT_CODES, "")  # which have pages of their own
    return re.sub(r"^Examples?: (.+)$", r"```console\n$ \1\n```", text, flags=re.MULTILINE)


def exit_codes():
    """The exit codes, as the help of each command has them."""
    from ratestate.interfaces.cli.exits import EXIT_CODES

    pairs = re.findall(r"(\d+) ([^,.]+)", EXIT_CODES)
    return "\n".join(["| code | |", "|---|---|", *(f"| {code} | {what} |" for code, what in pairs)])


#: keys of a scenario file that are no quantity, and what stands there
WORDS = {
    "law": "friction law",
    "friction_form": "form of friction",
    "law_file": "Python file with a friction law of your own",
    "steps": "steps, holds and ramps",
    "sinusoid": "oscillation about `V_lp`",
    "sigma loading": "normal stress at the times `t`",
    "sigma_steps": "steps and ramps of the normal stress",
    "sigma_sinusoid": "oscillation of the normal stress",
    "file loading": "file with a record",
    "columns": "columns of this file with times and speeds",
    "units": "units of these columns, if the header has none",
    "t": "times; `V_lp` then lists as many speeds",
    "function": "function to compute",
    "initial": "values at t = 0 that override the steady start",
    "times": "times to save",
    "method": "integration method",
    "frequency": "frequencies of a response",
    "file": "file for the numbers",
    "plot": "file for a figure",
}
#: of those, what is expected, where the code has no list of it
FORMS = {
    "steps": '`[{ t = "1 s", V_lp = "1 mm/s" }]`; `hold` in place of `V_lp`, or `ramp` in addition',
    "sinusoid": '`{ amplitude = "0.05 mm/s", period = "2 s" }`, or `frequency`',
    "sigma loading": '`["5 MPa", "5 MPa", "5.1 MPa", 5.1e6]`',
    "sigma_steps": '`[{ t = "1 s", sigma = "5.1 MPa" }]`; `ramp` in addition',
    "sigma_sinusoid": '`{ amplitude = "50 kPa", period = "2 s" }`, or `frequency`',
    "file loading": "a name such as `record.csv`",
    "columns": '`["time [s]", "V_lp [um/s]"]`, or numbers from 1 on',
    "units": '`["s", "um/s"]`',
    "t": '`[0, 10, "20 s"]`',
    "law_file": '`"mylaw.py"`, a path relative to this file',
    "initial": '`{ V = "1 um/s", theta = "10 s" }`; also `tau`, and other states of the law',
    "times": '`[0.5, "1 s"]`, or `{ from = 0, to = "200 s", n = 2001 }`',
    "frequency": '`"10 Hz"`, `[1, "10 Hz"]`, or `{ from = 1, to = 100, n = 21, scale = "log" }`',
}
#: what a key stands for that is not given
OTHERWISE = {
    "V_lp loading": "required without `file`",
    "t_end run": "required",
    "V_start run": "default: the first speed of the loading",
    "times run": "default: the solver's own steps",
    "frequency run": "only for `frequency_response`; default: decades around the resonance",
    "rtol run": "default: `1e-6` for `simulate`, `1e-8` for limit cycles",
    "method run": 'default: `"auto"`',
    "function run": 'default: `"simulate"`',
    "function sweep": "required",
}


def keys(table):
    """A writer of the keys of a table, as the reader of scenario files knows them."""

    def write():
        from ratestate.scenario.known_keys import TABLES, keys_of

        # the other keys of [sweep] are those of [slider]
        known = TABLES[table] if table == "sweep" else keys_of(table)
        rows = [_key(table, key) for key in known]
        if table == "sweep":
            rows.append("| any key of `[slider]` | | one value or many |")
        return "\n".join(["| key | | expected |", "|---|---|---|", *rows])

    return write


def _key(table, key):
    """A row: what the key stands for, and what is expected."""
    from ratestate.model.quantities import KINDS, QUANTITIES
    from ratestate.scenario.known_keys import ENDINGS, choices

    said = WORDS.get(f"{key} {table}", WORDS.get(key))
    wanted = FORMS.get(f"{key} {table}", FORMS.get(key, ""))
    if said is None:
        quantity = QUANTITIES[key]
        kind, _ = KINDS[quantity.unit]
        unit = "" if quantity.unit == "1" else f" [{quantity.unit}]"
        said, wanted = quantity.long_name, f"{kind}{unit} such as {quantity.example}"
    elif words := choices(key):
        wanted = " or ".join(f'`"{word}"`' for word in words)
    elif table == "output":
        wanted = "a name ending in " + ", ".join(f"`{end}`" for end in ENDINGS[key])
    return f"| `{key}` | {said} | {wanted}{_otherwise(table, key)} |"


def _otherwise(table, key):
    """What is taken for a parameter of the slider that is not given."""
    from ratestate.model.parameters import WHOLE_CONTACT
    from ratestate.scenario.known_keys import COMMON, NEEDED

    if table != "slider":
        said = OTHERWISE.get(f"{key} {table}")
        return f"; {said}" if said else ""
    if key == "law_file":
        return "; `law` may then be left out"
    if key in WHOLE_CONTACT:
        return f"; in place of `{WHOLE_CONTACT[key]}`, with `area`"
    if key not in COMMON:
        return f"; required with {_owners(key)}"
    return "; required" if key in NEEDED else f"; default: `{COMMON[key]!r}`"


def _owners(key):
    """The laws and forms of friction that have a parameter of their own."""
    from ratestate.friction.forms import FORMS
    from ratestate.friction.laws import laws_with

    forms = [name for name, form in FORMS.items() if key in form.OWN_PARAMETERS]
    return " or ".join(f'`"{name}"`' for name in [*laws_with(key), *forms])


def mistakes():
    """The message about a file with many mistakes."""
    from ratestate import ParameterError, scenario

    file = DOCS / "reference" / "wrong.toml"
    try:
        scenario.load(file)
    except ParameterError as error:
        return "\n".join(["```text", str(error).replace(f"{file.parent}/", ""), "```"])
    raise AssertionError("wrong.toml should not be usable")


def templates():
    """The scenario files that `ratestate init` writes, with what they say of themselves."""
    from ratestate.scenario.templates import TEMPLATES, description

    rows = [f"| `{name}` | {description(name)} |" for name in TEMPLATES]
    return "\n".join(["| name | |", "|---|---|", *rows])


#: public names of values, with their meaning; functions, classes and modules have docstrings
VALUES = {
    "QUANTITIES": "All quantities by symbol: unit, name, range and example.",
    "files.EXAMPLE_UNIT": "The quantities that a column of a record can be, each with a unit.",
    "plot.AMPLITUDE": "Label of an axis of amplitudes.",
    "plot.BLUE": "Colour of the paper's second curve.",
    "plot.GRAY": "Colour of records and guiding lines.",
    "plot.LAWS": "Name, colour and line of each friction law in figures.",
    "plot.RED": "Colour of the paper's first curve.",
    "plot.STRESS": "Label of an axis of tau/sigma.",
    "scenario.TEMPLATES": "Names of the templates of scenario files.",
}


def names():
    """Every public name, with the first sentence of its docstring."""
    import ratestate as rs

    documented = re.findall(
        r"^\.\. auto\w+:: ratestate\.(\S+)",
        (DOCS / "reference/api.md").read_text("utf-8"),
        re.MULTILINE,
    )
    packages = [name for name in dir(rs) if inspect.ismodule(getattr(rs, name))]
    tables = []
    for package in ("", *packages):
        rows = ["| name | |", "|---|---|"]
        for name in dir(getattr(rs, package) if package else rs):
            path = f"{package}.{name}".lstrip(".")
            if not name.startswith("_"):
                shown = (
                    f"{{obj}}`rs.{path} <ratestate.{path}>`"
                    if path in documented
                    else f"`rs.{path}`"
                )
                rows.append(f"| {shown} | {_first_sentence(path)} |")
        tables.append("\n".join(rows))
    return "\n\n".join(tables)


def _first_sentence(path):
    if path in VALUES:
        return VALUES[path]
    import ratestate as rs

    text = _one_line(inspect.getdoc(operator.attrgetter(path)(rs)))
    return re.sub(r"`ratestate\.(\w+)`", r"`\1`", text)


def modules():
    """Every module with the first sentence of its docstring, in the order of folders."""
    source = DOCS.parent / "src"
    folders = sorted({path.parent for path in source.rglob("*.py")})
    tables = []
    for folder in folders:
        name = ".".join(folder.relative_to(source).parts)
        rows = [f"## {name}", "", _sentence_of(folder / "__init__.py")]
        if paths := [path for path in sorted(folder.glob("*.py")) if path.stem[0] != "_"]:
            rows += ["", "| module | |", "|---|---|"]
            rows += [f"| `{path.stem}` | {_sentence_of(path)} |" for path in paths]
        tables.append("\n".join(rows))
    return "\n\n".join(tables)


def _sentence_of(path):
    docstring = ast.get_docstring(ast.parse(path.read_text("utf-8")))
    return _one_line(docstring)


def _one_line(docstring):
    return " ".join(docstring.partition("\n\n")[0].split()).replace("``", "`")


WRITERS = {
    "modules": modules,
    "names": names,
    "commands": commands,
    "exit_codes": exit_codes,
    "mistakes": mistakes,
    "templates": templates,
    "symbols": symbols.symbols,
    "material_values": materials.values,
    "material_models": materials.models,
    "material_findings": materials.findings,
    "material_sources": materials.sources,
    **{table: keys(table) for table in ("slider", "loading", "run", "sweep", "output")},
}


if __name__ == "__main__":
    for page in sorted(DOCS.rglob("*.md")):
        before = page.read_text("utf-8")
        if (now := current(before)) != before:
            page.write_text(now, "utf-8")


def setup(app):
    app.connect("source-read", fill)
    app.connect("env-get-outdated", outdated)
    return {"parallel_read_safe": True}
