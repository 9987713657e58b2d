"""Hundreds of damaged scenario files: each is refused in the form promised, or is still sound."""

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
COUNT = 500
VALUES = [
    *("true", '"3.2 mm"', '"three"', "nan", "inf", "-inf", "-1", "0", "1e400", "1e-400", "-1e300"),
    *("[]", "{}", "[[1]]", "[nan]", '["1 m", "2 s", "3 kg"]', "[1, 2, 3]", "1979-05-27", '""'),
    *('"1e999999999 m"', '"1 m**9**9**9"', '"-5 MPa"', '"10 furlong"', '"10"', "'\\u0041'"),
    *("9" * 5000, "0x" + "f" * 5000, '"' + "x" * 5000 + '"', '"10 um\\u0000"', '"10 \\n um"'),
    *("{ from = 1 }", "{ from = 1, to = 2, n = 10_000_000_000 }", "{ from = -1, to = nan, n = 3 }"),
    *('{ form = 1, to = "2 m", n = 2.5, scale = "ln" }', "{ V_lp = 1, hold = 2 }", "{ a.b = 1 }"),
    *("[{ t = 1, V_lp = -1 }, { t = 0 }, { ramp = 3 }, 4]", '"../../out.exe"'),
    *("[" * 100_000, "{a=" * 5000, "[" * 60 + "]" * 60, "0\n" + ".".join("a" * 5000) + " = 1"),
]
NAMES = "a b Dc sigma K M law V_lp steps sinusoid file columns units t t_end times rtol".split()
ODD = ['"', "'", "[", "}", "=", "\x00", "\r", "\u2028", "\ufeff", "\\", ".", "#", "\u00b5"]


def damaged(text, rng):
    """Damage a file in one way or two."""
    lines = text.split("\n")
    for _ in range(rng.choice([1, 1, 2])):
        given = [i for i, line in enumerate(lines) if re.match(r"[A-Za-z_]\w* = |\[\w+\]", line)]
        if not given:
            break
        i, j = rng.choice(given), rng.choice(given)
        key, k = lines[i].partition(" = ")[0], rng.randrange(len(lines[i]))
        way = rng.randrange(8)
        if way == 0:
            lines[i] = f"{key} = {rng.choice(VALUES)}"
        elif way == 1:  # another number or unit
            lines[i] = re.sub(r"\d[\d.e-]*", rng.choice(["1e300", "-3", "0", "1e-320"]), lines[i])
            unit = rng.choice(["kg", "Pa/s", "blorp", "m/s^3", "%", "degC", "1/0", "m**1e9"])
            lines[i] = re.sub(r' [^ "]+"', f' {unit}"', lines[i], count=rng.randrange(2))
        elif way == 2:  # a letter too few or too many
            lines[i] = lines[i][:k] + rng.choice(["", 2 * lines[i][k]]) + lines[i][k + 1 :]
        elif way == 3:
            lines[i] = lines[i][:k] + rng.choice(ODD) + lines[i][k:]
        elif way == 4:
            del lines[i]
        elif way == 5:
            lines.insert(j, lines.pop(i))
        elif way == 6:
            new = rng.choice([f"{rng.choice(NAMES)} = {rng.choice(VALUES)}", "[a.b.c]\nx = 1"])
            lines.insert(i, new)
        else:  # cut short
            lines[i:] = [lines[i][:k]]
    data = "\n".join(lines).encode("utf-8", "surrogatepass")
    k = rng.randrange(len(data) + 1)
    other = [b"", b"\xff\xfe" + text.encode("utf-16-le"), text.encode("utf-32"), rng.randbytes(300)]
    other += [data[:k] + b"\xb5" + data[k:], data.replace(b"\n", b"\r"), b"\xef\xbb\xbf" + data]
    return rng.choice(other) if rng.random() < 0.1 else data


#: a line of the message: where, what is wrong, what to do
FORM = re.compile(
    r"(line \d+, )?(\[[^]]+\]( ('.*?'|[\w.\[\]-]+))?|[\w-]+|'.*?'|\['.*?'\]|the file): .+[^.]\. "
    r"[A-Z].*[.?]",
    re.S,
)


def is_refused(path):
    """Whether a file is refused; if it is, then in due form."""
    try:
        found = load(path)
    except ParameterError as error:
        check(str(error), path)
        return True
    (path.parent / "again.toml").write_text(toml(found))
    assert load(path.parent / "again.toml").slider == found.slider
    return False


def check(message, path):
    """Check that a message has the form promised."""
    title, *lines = message.split("\n")
    assert len(title) < 500
    assert all(len(line) < 600 for line in lines)
    if title.endswith(" cannot be used:"):
        assert lines
        assert [line for line in lines if not FORM.fullmatch(line)] == []
    else:
        assert not lines
        what = re.escape(str(path)) + " (is not valid TOML|cannot be read): .+ "
        assert re.match(what, title)


def test_damaged_files_are_refused_in_due_form(tmp_path):
    shutil.copy(FOLDER / "recorded-loading.csv", tmp_path)
    path, rng, refused = tmp_path / "damaged.toml", random.Random(5), 0
    for _ in range(COUNT):
        path.write_bytes(damaged(rng.choice([*FILES.values()]), rng))
        refused += is_refused(path)
    assert 0.7 * COUNT < refused < COUNT  # some damage does no harm


@pytest.mark.parametrize("name", FILES)
def test_undamaged_files_are_sound(name, tmp_path):
    shutil.copy(FOLDER / "recorded-loading.csv", tmp_path)
    path = tmp_path / "sound.toml"
    path.write_text(FILES[name])
    assert not is_refused(path)


def test_the_table_of_messages_holds_those_that_are_used():
    folder = Path(scenario.__file__).parent
    tables = tomllib.loads((folder / "messages.toml").read_text("utf-8"))
    held = {f"{table}.{name}" for table, messages in tables.items() for name in messages}
    source = "".join(p.read_text("utf-8") for p in folder.glob("*.py") if p.stem != "__init__")
    used = set(re.findall(rf'"((?:{"|".join(tables)})\.[a-z]\w*)"', source))
    assert used == held
