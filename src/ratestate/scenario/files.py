"""Read scenario files."""

import re
import tomllib
from pathlib import Path
from typing import Any

from ..errors import MissingFileError, ParameterError
from ..friction.composition import composed
from ..friction.forms import form_name
from ..friction.law import FrictionLaw
from ..friction.laws import DEFAULT, friction_law
from ..model.names import one_of
from .assemble import Tables, assemble
from .known_keys import TABLES, example, tables_with
from .law_file import take_law_file
from .loading_table import loading_table
from .problems import Place, Problem, choice, message, refusal, report, written
from .scenario import FUNCTIONS, Scenario
from .tables import plain_table, sweep_table
from .templates import TEMPLATES

LARGEST = 10**7  # bytes
DEEPEST = 50  # keys with dots between them: time and memory go with the square
MOST_TABLES = 100


def load(
    path: str | Path, function: str | None = None, *, law_file: str | Path | None = None
) -> Scenario:
    """Read a scenario file.

    Parameters
    ----------
    path : str or Path
        A TOML file with the tables [slider], [loading], [run], [sweep] and [output]; see
        `ratestate.scenario`.  [slider] and a speed of the load point, in [loading] or [sweep], are
        required, and for "simulate" ``t_end``.
    function : str, optional
        Function to call, as in `Scenario`, in place of the one that [sweep] or [run] names, or in
        place of "simulate" if they name none.  Keys that the function does not take are checked,
        but left out.
    law_file : str or Path, optional
        Python file with the friction law, in place of the key law_file of the scenario.  A law file
        is code, which is run.

    Returns
    -------
    Scenario
        The checked scenario.

    Raises
    ------
    ParameterError
        If the file or the law file cannot be read or used.  Every problem in the file is a line of
        the message: ``line 4, [table] key: the problem. The remedy, such as an example.``
    """
    path = Path(path)
    return loads(_bytes(path), function, name=str(path), folder=path.parent, law_file=law_file)


def loads(
    text: str | bytes,
    function: str | None = None,
    *,
    name: str = "the text",
    folder: Path | None = None,
    law_file: str | Path | None = None,
) -> Scenario:
    """Read the text of a scenario file.

    Parameters
    ----------
    text : str or bytes
        TOML; bytes are UTF-8.
    function : str, optional
        As for `load`.
    name : str
        Name of the text in messages.
    folder : Path, optional
        Folder to which paths of records and of a law file are relative.  By default it is the
        current directory, and a text that names a law file is refused.
    law_file : str or Path, optional
        As for `load`.

    Returns
    -------
    Scenario
        The checked scenario.

    Raises
    ------
    ParameterError
        As for `load`.
    """
    function = None if function is None else choice(function, FUNCTIONS)
    problems: list[Problem] = []
    data = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    parsed = _tables(_parse(data, name), problems)
    take_law_file(parsed, law_file, folder, problems)
    slider = plain_table("slider", parsed.get("slider", {}), problems)
    of_sweep = parsed.get("sweep", {})
    law = _law_of(slider | {k: of_sweep[k] for k in ("law", "friction_form") if k in of_sweep})
    run = plain_table("run", parsed.get("run", {}), problems, law)
    function_of_run = run.pop("function", None)
    sweep = sweep_table(parsed.get("sweep"), function, function_of_run, problems, law)
    # (an area with a problem, which is noted, is not missing too)
    area = {
        key: 1.0 if value is None else value
        for key, value in (slider | sweep.values).items()
        if key == "area"
    }
    tables = Tables(
        problems=problems,
        names=frozenset(parsed),
        slider=slider,
        loading=loading_table(parsed.get("loading", {}), folder or Path(), problems, area),
        run=run,
        sweep=sweep,
        output=plain_table("output", parsed.get("output", {}), problems),
    )
    scenario = assemble(tables)
    if scenario is None:
        lines = report(problems, TABLES, data.decode("utf-8-sig"))
        raise refusal("file.unusable", name=name, lines=lines)
    return scenario


def _law_of(slider: dict[str, Any]) -> FrictionLaw | None:
    """Return the law of a slider with its form of friction and damping; None if it is unknown."""
    try:
        law = friction_law(slider.get("law", DEFAULT))
        form = form_name(slider.get("friction_form", law.form))
        return composed(law, form, bool(slider.get("damping")))
    except ParameterError:  # noted when the slider is read, or made
        return None


def _parse(text: bytes, name: str) -> dict[str, Any]:
    if len(text) > LARGEST:
        problem = message("file.too_large", size=len(text), most=LARGEST)
        raise refusal("file.unreadable", name=name, what=problem)
    try:
        if not (deep := _line_of_deep_key(text)):
            return tomllib.loads(text.decode("utf-8-sig"))
        problem = message("file.deep_key", line=deep, most=DEEPEST)
    except UnicodeDecodeError as error:
        problem = message("file.not_utf8", line=text[: error.start].count(b"\n") + 1)
    except RecursionError:
        problem = message("file.deep_brackets")
    except tomllib.TOMLDecodeError as error:
        reason, _, position = str(error).partition(" (at ")
        number = re.match(r"line (\d+)", position)
        lines = (text if number else text.rstrip()).decode().split("\n")
        k = int(number[1]) if number else len(lines)  # else it is the end of the document
        problem = message("file.broken", given=lines[k - 1].strip(), line=k, what=reason)
    except ValueError:
        problem = message("file.huge_integer")
    raise refusal("file.no_toml", name=name, what=problem)


def _bytes(path: Path) -> bytes:
    """Return the content of a file that exists and is not too large."""
    try:
        size = path.stat().st_size
        if not path.is_file():
            problem = "Is a directory" if path.is_dir() else "it is not a file"
        elif size > LARGEST:
            problem = message("file.too_large", size=size, most=LARGEST)
        else:
            return path.read_bytes()
    except FileNotFoundError:
        name, wanted = repr(str(path))[1:-1], _likely_file(path)
        raise refusal("file.missing", MissingFileError, name=name, wanted=wanted) from None
    except OSError as error:
        problem = str(error.strerror)
    except ValueError:  # a null character in the path
        problem = "no such name"
    raise refusal("file.unreadable", name=repr(str(path))[1:-1], what=problem)


def _likely_file(path: Path) -> str:
    """Return the remedy for a missing file: the file that is probably meant, or how to make it."""
    if (file := path.with_name(f"{path.name}.toml")).is_file():
        return f"Did you mean {file}?"
    kind = path.stem if path.stem in TEMPLATES else "lab"
    return f"`ratestate init {kind}` writes a scenario file, {kind}.toml."


def _line_of_deep_key(text: bytes) -> int:
    """Return the line, from 1 on, of a key with far too many parts; 0 if there is none."""
    for number, line in enumerate(text.split(b"\n"), 1):
        if line.count(b".") > DEEPEST and not line.lstrip().startswith(b"#"):
            for piece in re.split(rb"[,=\[\]{}#]", line):
                joints = re.findall(rb"[^.\s][ \t]*\.(?=[ \t]*[^.\s])", piece)
                if len(joints) > DEEPEST:
                    return number
    return 0


def _tables(parsed: dict[str, Any], problems: list[Problem]) -> dict[str, dict[str, Any]]:
    """Return the known tables of the file; an empty one replaces a value that is not a table."""
    tables: dict[str, dict[str, Any]] = {}
    known = [f"[{name}]" for name in TABLES]
    for name, table in list(parsed.items())[:MOST_TABLES]:
        place = Place((name,), problems)
        if name in TABLES:
            tables[name] = table if isinstance(table, dict) else {}
            if not isinstance(table, dict):
                place.add("table.none", given=table, wanted=one_of(known))
        elif isinstance(table, dict):
            place.add("table.unknown", wanted=one_of(known, written(place.path)))
        else:  # a key
            homes = tables_with(name)
            wanted = f"Write it in {homes}, such as {example(name)}." if homes else one_of(known)
            Place(("", name), problems).add("table.loose_key", wanted=wanted)
    if len(parsed) > MOST_TABLES:
        Place(("",), problems).add("table.too_many", n=len(parsed), wanted=one_of(known))
    return tables
