"""Hundreds of damaged scenario files: each is refused in the form promised, or is still sound."""

import contextlib
import random
import re
import shutil
import tomllib
from pathlib import Path

import pytest
from paths import TEMPLATES as FOLDER

from ratestate import ParameterError, scenario
from ratestate.scenario import TEMPLATES, load, template, toml

FILES = {name: template(name) for name in sorted(TEMPLATES)}
RECORD = FOLDER / "recorded-loading.csv"
TIMES = 40  # mutants of each kind

VALUES = [
    *("true", '"3.2 mm"', '"three"', "nan", "inf", "-inf", "-1", "0", "1e400", "1e-400", "-1e300"),
    *("[]", "{}", "[[1]]", "[nan]", '["1 m", "2 s", "3 kg"]', "[1, 2, 3]", "1979-05-27", '""'),
    *('"1e999999999 m"', '"1 m**9**9**9"', '"-5 MPa"', '"10 furlong"', '"10"', "'\\u0041'"),
    *("9" * 5000, "0x" + "f" * 5000, '"' + "x" * 5000 + '"', '"10 um\\u0000"', '"10 \\n um"'),
    *("{ from = 1 }", "{ from = 1, to = 2, n = 10_000_000_000 }", "{ from = -1, to = nan, n = 3 }"),
    *('{ form = 1, to = "2 m", n = 2.5, scale = "ln" }', "{ V_lp = 1, hold = 2 }", "{ a.b.c = 1 }"),
    *(
        "[{ t = 1, V_lp = -1 }, { t = 0 }, { ramp = 3 }, 4]",
        '"../../out.exe"',
        '"recorded-loading.csv"',
    ),
]
KEYS = "a b Dc sigma K M law V_lp steps sinusoid file columns units t t_end times rtol".split()
KEYS.append("function")
TABLES = ["slider", "loading", "run", "sweep", "output"]


def keys(lines):
    """Numbers of the lines that give a key, one line long, its value."""
    whole = re.compile(r"[A-Za-z_]\w* = (?!\[$)[^#]+")
    return [i for i, line in enumerate(lines) if whole.match(line)]


def misspelt(word, rng):
    """A word with two letters exchanged, one left out, or one doubled."""
    i = rng.randrange(len(word))
    return rng.choice([word[:i] + word[i + 1 :], word[:i] + 2 * word[i] + word[i + 1 :]])


def another_value(lines, rng):
    i = rng.choice(keys(lines))
    lines[i] = f"{lines[i].split(' = ')[0]} = {rng.choice(VALUES)}"


def another_unit(lines, rng):
    i = rng.choice([i for i in keys(lines) if '"' in lines[i] and " " in lines[i].split('"')[1]])
    unit = rng.choice(["m", "kg", "Pa/s", "blorp", "m/s^3", "%", "", "degC", "1/0", "m**1e9"])
    lines[i] = re.sub(r'"([-+.\de]+) [^"]*"', rf'"\1 {unit}"', lines[i])


def another_size(lines, rng):
    i = rng.choice([i for i in keys(lines) if re.search(r"\d", lines[i])])
    x = rng.choice(["1e300", "1e-320", "-3", "0", "1e18", "99999999999999999999", "0.0000000001"])
    lines[i] = re.sub(r"(?<![\w.])\d[\d.e-]*", x, lines[i], count=1)


def no_such_key(lines, rng):
    i = rng.choice(keys(lines))
    key, value = lines[i].split(" = ", 1)
    lines[i] = f"{misspelt(key, rng)} = {value}"


def no_such_table(lines, rng):
    i = rng.choice([i for i, line in enumerate(lines) if re.match(r"\[\w+\]", line)])
    lines[i] = f"[{misspelt(lines[i].strip()[1:-1], rng)}]"


def missing_line(lines, rng):
    del lines[rng.choice(keys(lines))]


def missing_table(lines, rng):
    del lines[rng.choice([i for i, line in enumerate(lines) if re.match(r"\[\w+\]", line)])]


def extra_key(lines, rng):
    lines.insert(rng.randrange(len(lines)), f"{rng.choice(KEYS)} = {rng.choice(VALUES)}")


def wrong_table(lines, rng):
    tables = [i for i, line in enumerate(lines) if re.match(r"\[\w+\]", line)]
    moved = lines.pop(rng.choice(keys(lines)))
    lines.insert(rng.choice([i for i in tables if i < len(lines)]) + 1, moved)


def extra_table(lines, rng):
    lines += [f"[{rng.choice([*TABLES, 'solver', 'a.b.c', '[x]'])}]", "x = 1"]


def cut_short(lines, rng):
    text = "\n".join(lines)
    lines[:] = text[: rng.randrange(len(text))].split("\n")


def odd_character(lines, rng):
    i = rng.choice(keys(lines))
    k = rng.randrange(len(lines[i]))
    odd = rng.choice(
        ['"', "'", "[", "}", "=", "\x00", "\r", "\u2028", "\ufeff", "\\", ".", "#", "µ"]
    )
    lines[i] = lines[i][:k] + odd + lines[i][k:]


def deep(lines, rng):
    i = rng.choice(keys(lines))
    n = rng.choice([60, 5000, 100_000])
    value = rng.choice(["[" * n, "{a=" * n, "[" * n + "]" * n, "0\n" + ".".join("a" * n) + " = 1"])
    lines[i] = f"{lines[i].split(' = ')[0]} = {value}"


LINEWISE = [
    *(another_value, another_unit, another_size, no_such_key, no_such_table, missing_line),
    *(missing_table, extra_key, wrong_table, extra_table, cut_short, odd_character, deep),
]


def other_bytes(text, rng):
    data = text.encode()
    k = rng.randrange(len(data))
    return rng.choice(
        [
            b"",
            b"\n\n",
            b"\xef\xbb\xbf" + data,
            b"\xff\xfe" + text.encode("utf-16-le"),
            text.encode("utf-32"),
            data[:k] + b"\xb5" + data[k:],
            data[:k] + b"\x00" * 100 + data[k:],
            data.replace(b"\n", b"\r"),
            rng.randbytes(300),
            b"\x1f\x8b\x08" + data,
        ]
    )


def mutants():
    """Seeded: (number, text as bytes)."""
    rng = random.Random(5)
    made = []
    for change in LINEWISE:
        for _ in range(TIMES):
            lines = rng.choice([*FILES.values()]).split("\n")
            change(lines, rng)
            if rng.random() < 0.3:
                with contextlib.suppress(IndexError):  # there is nothing left to change
                    rng.choice(LINEWISE)(lines, rng)
            made.append("\n".join(lines).encode("utf-8", "surrogatepass"))
    return made + [other_bytes(rng.choice([*FILES.values()]), rng) for _ in range(TIMES)]


#: a line of the message: where, what is wrong, what to do
FORM = re.compile(
    r"(line \d+, )?(\[[^]]+\]( ('.*?'|[\w.\[\]-]+))?|[\w-]+|'.*?'|\['.*?'\]|the file): .+[^.]\. "
    r"[A-Z].*[.?]",
    re.S,
)


def refused(path):
    """Whether a file is refused; if it is, then in due form."""
    try:
        scenario = load(path)
    except ParameterError as error:
        check(str(error), path)
        return True
    (path.parent / "again.toml").write_text(toml(scenario))
    assert load(path.parent / "again.toml").slider == scenario.slider
    return False


def check(message, path):
    """Check that a message has the form promised."""
    title, *lines = message.split("\n")
    assert len(title) < 500
    assert all(len(line) < 600 for line in lines)
    if title.endswith(" cannot be used:"):
        assert lines
        wrong = [line for line in lines if not FORM.fullmatch(line)]
        assert not wrong, wrong
    else:
        assert not lines
        what = re.escape(str(path)) + " (is not valid TOML|cannot be read): .+ "
        assert re.match(what, title)


def test_damaged_files_are_refused_in_due_form(tmp_path):
    shutil.copy(RECORD, tmp_path)
    path = tmp_path / "mutant.toml"
    found = []
    for text in mutants():
        path.write_bytes(text)
        found.append(refused(path))
    assert len(found) == TIMES * (len(LINEWISE) + 1)
    assert sum(found) > 400
    assert not all(found)  # some damage does no harm


@pytest.mark.parametrize("name", FILES)
def test_undamaged_files_are_sound(name, tmp_path):
    shutil.copy(RECORD, tmp_path)
    path = tmp_path / "sound.toml"
    path.write_text(FILES[name])
    assert not refused(path)


def test_the_table_of_messages_holds_those_that_are_used():
    folder = Path(scenario.__file__).parent
    tables = tomllib.loads((folder / "messages.toml").read_text("utf-8"))
    held = {f"{table}.{name}" for table, messages in tables.items() for name in messages}
    source = "".join(p.read_text("utf-8") for p in folder.glob("*.py") if p.stem != "__init__")
    used = set(re.findall(rf'"((?:{"|".join(tables)})\.[a-z]\w*)"', source))
    assert used == held
