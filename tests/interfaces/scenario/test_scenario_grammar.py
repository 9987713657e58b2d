"""What the tables of a scenario file mean, and which are refused."""

import re

import numpy as np
import pytest
import scenario_files
from scenario_problems import problem_lines

import ratestate as rs
from ratestate import Loading, ParameterError
from ratestate.scenario import Output, from_result, load, loads, toml

SLIDER = scenario_files.SLIDER + "M = 3000\n"
RUN = '[run]\nt_end = "10 s"\n'
CSV = "time [s],V_lp [um/s],no unit\n0,1,x\n1,1,x\n1,3,x\n2.5,3,x\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("grammar")


@pytest.fixture
def read(folder):
    """Load a scenario of the tables given, beside [slider]."""

    def read(text, function=None, slider=SLIDER):
        path = folder / "it.toml"
        path.write_text(slider + text)
        return load(path, function)

    return read


@pytest.fixture
def problems(read):
    """Return the lines on these tables, without the title."""

    def problems(text, function=None, slider=SLIDER):
        with pytest.raises(ParameterError) as caught:
            read(text, function, slider)
        assert str(caught.value).splitlines()[0].endswith("it.toml cannot be used:")
        lines = problem_lines(caught.value)
        form = r"\[\w+\].*: .+[^.]\. [A-Z][^.]+.*[.?]"
        assert all(re.fullmatch(form, line) for line in lines), lines
        return lines

    return problems


def same(one, other):
    """Whether two loadings have the same bits."""
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("t", "V", "rate", "t_last")
    )


@pytest.mark.parametrize(
    ("table", "loading"),
    [
        ('V_lp = "3.2 mm/s"', Loading.constant("3.2 mm/s")),
        (
            'V_lp = 1e-3\nsteps = [{ t = "500 ms", V_lp = "3.2 mm/s" }, { t = 2, V_lp = 0 }]',
            Loading.steps(1e-3, (0.5, "3.2 mm/s"), (2, 0)),
        ),
        (
            'V_lp = 1e-3\nsteps = [{t=1, hold="2 s"}, {t=3, V_lp=2e-3}, {t=4, V_lp=0, ramp="1 s"}]',
            Loading.constant(1e-3).hold(1, 2).step(3, 2e-3).ramp(4, 0, 1),
        ),
        (
            'V_lp = 1e-3\nsinusoid = { amplitude = "1 mm/s", period = "2 s" }',
            Loading.sinusoid(1e-3, 1e-3, period=2, t_end=10),
        ),
        (
            'V_lp = 1e-3\nsinusoid = { amplitude = 1e-4, frequency = "0.3 Hz" }',
            Loading.sinusoid(1e-3, 1e-4, frequency=0.3, t_end=10),
        ),
        (
            't = [0, 1, 1, "1 min"]\nV_lp = [1e-3, "2 mm/s", 0, 1]',
            Loading.series([0, 1, 1, 60], [1e-3, 2e-3, 0, 1]),
        ),
        ("t = { from = 0, to = 20, n = 3 }\nV_lp = [1, 2, 3]", None),
    ],
)
def test_loadings(read, problems, table, loading):
    text = f"[loading]\n{table}\n{RUN}"
    if loading is None:
        (line,) = problems(text)
        assert line.startswith("[loading] t: a table is not a list. Give as many values")
        return
    scenario = read(text)
    assert scenario.function == "simulate"
    assert scenario.settings.keys() == {"loading", "t_end"}
    assert scenario.settings["t_end"] == 10
    assert scenario.output == Output()
    assert same(scenario.settings["loading"], loading)


RECORD = Loading.series([0, 1, 1, 2.5], [1e-6, 1e-6, 3e-6, 3e-6])


@pytest.mark.parametrize(
    ("name", "content", "more"),
    [
        ("a.csv", CSV, 'columns = ["time [s]", "V_lp [um/s]"]'),
        ("a.csv", CSV, 'columns = ["time", "V_lp"]'),
        ("a.csv", CSV, "columns = [1, 2]"),
        ("a.csv", CSV, 'columns = ["time", 2]\nunits = ["s", "um/s"]'),
        ("b.csv", CSV.split("\n", 1)[1], 'columns = [1, 2]\nunits = ["s", "um/s"]'),
        ("b.txt", CSV.replace(",", ";").replace(".", ","), 'columns = ["time", "V_lp"]'),
        (
            "b.csv",
            "V [mm/hour],t [ms]\n3.6,0\n3.6,1e3\n10.8,1000\n10.8,2500",
            'columns = ["t", "V"]',
        ),
    ],
)
def test_a_recorded_loading_is_read_from_files_of_many_forms(read, folder, name, content, more):
    (folder / name).write_text(content, newline="")
    table = f'[loading]\nfile = "{name}"\n{more}\n[run]\nt_end = 2'
    assert same(read(table).settings["loading"], RECORD)
    assert read(table, "limit_cycle").settings == {"V_lp": 3e-6}


NO_RECORD = [
    (CSV, 'columns = ["t [s]", "V_lp"]', "columns[0]: 't [s]' is not a column"),
    # an error of the reader of records keeps its words
    (CSV, 'columns = ["tiem", "V_lp"]', "columns[0]: 'tiem' is not a column"),
    ("", "columns = [1, 2]", "file: x.csv is empty"),
    (CSV, 'columns = ["time", "no unit"]', "columns[1]: 'no unit' has no unit"),
    (CSV, "", "columns: is missing"),
    (CSV, "columns = [2, 1]", "columns[0]: 'um/s' is a speed"),
    (CSV, 'columns = [1, 2]\nunits = ["s", "x"]', "units[1]: 'x' is unknown"),
    (CSV, 'columns = [1, 2]\nunits = "s"', "units: 's' is not a pair"),
    (CSV.replace("1,3,x", "1,?,x"), "columns = [1, 2]", "file: line 4: 'V_lp [um/s]' has '?'"),
    (CSV.replace("1,3,x", "1,-3"), "columns = [1, 2]", "file: V_lp = -3e-06 m/s at row[2] must be"),
    (CSV.replace("2.5", "0.5"), "columns = [1, 2]", "file: t[3] = 0.5 s is less than t[2] = 1.0 s"),
    (CSV + 6 * "a,b,c\n", "columns = [1, 2]", "file: and 7 more cells"),
]


@pytest.mark.parametrize(("content", "more", "line"), NO_RECORD)
def test_bad_records(problems, folder, content, more, line):
    (folder / "x.csv").write_text(content)
    lines = problems(f'[loading]\nfile = "x.csv"\n{more}\n[run]\nt_end = 2')
    beginning = ".*".join(map(re.escape, f"[loading] {line}".split(" * ")))
    assert any(re.match(beginning, found) for found in lines), lines


@pytest.mark.parametrize(
    ("symbol", "refused"),
    [("a", "0.99e-12"), ("b", "-101"), ("Dc", "1.01e9"), ("sigma", "1.01e15"), ("V0", "0.99e-50")],
)
def test_sizes_of_a_slider(problems, symbol, refused):
    slider = re.sub(rf"(?m)^{symbol} = .*\n", "", SLIDER) + f"{symbol} = {refused}\n"
    (line,) = problems(f"[loading]\nV_lp = 1\n{RUN}", slider=slider)
    assert line.startswith(f"[slider] {symbol}: ")
    assert " is far outside the usual range, " in line


def test_extreme_sizes_are_accepted(read):
    """A fault that is locked, a laboratory, an asteroid, a rigid spring without friction."""
    slider = """
        [slider]
        a = [1.01e-12, 0.003, 99]
        b = [-99, 0, 1e-20, 99]
        Dc = ["1.01 fm", "10 um", "9.9e5 km"]
        sigma = ["1.01 nPa", "2 MPa", "990 TPa"]
        K = [1.01e-20, "900 MPa/m", 9.9e24, inf]
        M = [0, 1.01e-20, 3000, 9.9e19]
        mu0 = [0, 0.6, 990]
        V0 = ["1.01e-50 m/s", "1 nm/s", "99 km/s"]
    """
    lists = (
        "[sweep]" + slider.split("[slider]")[1] + "function = 'stability'\nV_lp = [2e-50, 9e4]\n"
    )
    assert read(lists, slider="").slider.K.values[-1] == np.inf
    for theta, t_end in ((9.9e39, 9.9e17), (1.01e-20, 1.01e-20)):
        start = f"V_start = 1e-30\ninitial = {{ theta = {theta}, V = 1e-30, tau = -9.9e14 }}\n"
        scenario = read(f"[loading]\nV_lp = 0\n[run]\nt_end = {t_end}\n{start}")
        assert scenario.settings["t_end"] == t_end


def test_a_wrong_start_stands_beside_other_problems(problems):
    slider = SLIDER.replace("M = 3000", "M = 0")
    clash = "initial = { V = 1, theta = 1, tau = 1 }\n"
    for loading, table, others in [
        ("V_lp = 1", "t_end = 1\nrtol = 3", 1),
        ("V_lp = 1", "t_end = 1\ntimes = [2]", 1),
        ("V_lp = 1", "times = 'x'", 2),
        ("V_lp = '1 m'", "t_end = 1", 1),
        ("t = [0, 1]\nV_lp = [1, 1]", "t_end = 5", 1),
        ("V_lp = 0", "t_end = 5", 1),
    ]:
        lines = problems(f"[loading]\n{loading}\n[run]\n{table}\n{clash}", slider=slider)
        assert len(lines) == 1 + others
        assert sum(line.startswith("[run] initial: initial V, theta and") for line in lines) == 1


def test_only_similar_names_are_suggested(problems):
    (line,) = problems(f"[loading]\nV_lp = 1\ntitle = 'x'\n{RUN}")
    assert "Did you mean" not in line


def test_no_error_of_a_slider_is_without_a_line(problems, monkeypatch):
    def refuses(**_):
        raise ParameterError("a and b fell out with each other", "Part them.")

    monkeypatch.setattr("ratestate.scenario.assemble.SpringSlider", refuses)
    (line,) = problems(f"[loading]\nV_lp = 1\n{RUN}")
    assert line == "[slider]: a and b fell out with each other. Part them."


LOADINGS = [
    ('V_lp = "1e12 mm/s"', "V_lp: '1e12 mm/s' is far outside the usual range, 1e-50"),
    ("V_lp = 1\nsteps = [{ t = 1e19, V_lp = 1 }]", "steps[0].t: 1e+19 is far outside"),
    ("t = [0, 20]\nV_lp = [0, 1e6]", "V_lp[1]: 1000000.0 is far outside the usual range"),
    (
        "V_lp = 1\nsinusoid = { amplitude = 1, frequency = '1e30 Hz' }",
        "sinusoid.frequency: '1e30 Hz' is far outside the usual range, 1e-18 to 1e+20 Hz",
    ),
    ("file = 'fast.csv'\ncolumns = [1, 2]", "file: V_lp = 1e+06 m/s is far outside the usual"),
    ("file = '''a\nb.csv'''", "file: 'a\\nb.csv' is not the name of a file"),
    ("file = 'it.toml'\ncolumns = [1, 2]", "file: * has no line of numbers"),
    (f"file = '{'x' * 500}.csv'\ncolumns = [1, 2]", "file: * cannot be read: File name too"),
    ("V_lp = { from = 1 }", "V_lp: a table makes an axis"),
    ("V_pl = 1", "V_pl: unknown key. Give one of * Did you mean V_lp?"),
    ("t_end = 1", "t_end: is in the wrong table"),
    ("V_lp = 1\nsteps = []", "steps: a list of 0 is not a list of 1 to 1000 steps"),
    ("V_lp = 1\nsteps = [{t=1}]", "steps[0].V_lp: is missing"),
    ("V_lp = 1\nsteps = [{t=1, V_lp='1 m'}]", "steps[0].V_lp: '1 m' is a length"),
    ("V_lp = 1\nsteps = [{t=1, hold=1, V_lp=1}]", "steps[0].V_lp: is given in addition to hold"),
    ("V_lp = 1\nsteps = [{t=1, hodl=1}]", "steps[0].hodl: unknown key. * Did you mean hold?"),
    (
        "V_lp = 1\nsteps = [{t=2, hold=2}, {t=3, V_lp=1}, {t=1, V_lp=1}, {t=9, V_lp=1}]",
        "steps[1]: t = 3.0 s must come after t = 4.0 s",
    ),
    ("V_lp = 1\nsinusoid = {}", "sinusoid.amplitude: is missing"),
    ("V_lp = 1\nsinusoid = {amplitude=1}", "sinusoid.period: is missing"),
    (
        "V_lp = 1\nsinusoid = {amplitude=1, period=1, frequency=1}",
        "sinusoid.period: is given twice",
    ),
    ("V_lp = 1\nsinusoid = {amplitude=2, period=1}", "sinusoid: amplitude = 2 m/s is more than"),
    ("V_lp = 1\nsteps = [{t=1, V_lp=1}]\nt = [1]", "* has steps and t"),
    (
        "t = [0]\nV_lp = [1]\nsteps = [{t=1, V_lp=1}]\nsinusoid = {amplitude=1, period=1}",
        "* has steps and sinusoid and t",
    ),
    ("t = [0, 1]\nV_lp = 1", "V_lp: 1 is not a list"),
    ("t = [0, 1]\nV_lp = [1, 2, 3]", "t: has 2 and V_lp 3 values"),
    ('t = [0, 20]\nV_lp = [1, "2 mm"]', "V_lp[1]: '2 mm' is a length"),
    ("columns = [1, 2]\nV_lp = 1", "columns: is given without file"),
    ("V_lp = 1\nsigma = [1, 2]", "sigma: is given without t"),
    ("V_lp = 1\nsigma_steps = [{t=1}]", "sigma_steps[0].sigma: is missing"),
    ("V_lp = 1\nsigma_sinusoid = {amplitude=1}", "sigma_sinusoid.period: is missing"),
    ("V_lp = 1\nfile = 'a.csv'\ncolumns = [1, 2]", "V_lp: is given in addition to file"),
    ("", "V_lp: is missing"),
]


OUTPUTS = [
    ("file = 3", "file: 3 is not text"),
    ('file = "x.png"', "file: 'x.png' has an unsupported ending"),
    ('plot = "x.svg"', "plot: 'x.svg' has an unsupported ending"),
    ('plot = "no/where.png"', "plot: 'no/where.png' is in a folder that does"),
    ('plot = "x\\ny.png"', "plot: 'x\\ny.png' cannot be the name of a file"),
    ('flie = "x.nc"', "flie: unknown key"),
]
RUNS = [
    ("t_end = '1 s. Give a time [s]'", "t_end: '1 s. Give a time [s]' has an unknown unit"),
    ("t_end = 10\nV_start = 0", "V_start: 0 m/s must be > 0"),
    ("t_end = [1, 2]", "t_end: a list of 2 makes an axis"),
    ("t_end = 1.01e18", "t_end: 1.01e+18 is far outside the usual range, 1e-20 to 1e+18 s"),
    (
        "t_end = 1\ninitial = { theta = 1.01e40 }",
        "initial.theta: 1.01e+40 is far outside the usual",
    ),
    ("t_end = 1\ndt = 1e-4", "dt: unknown key"),
    ("t_end = 1\ninitial = { mu = 1 }", "initial.mu: unknown key"),
    ("t_end = 1\ninitial = { V = '1 s' }", "initial.V: '1 s' is a time"),
    ("", "t_end: is missing"),
]


BEFORE = {"loading": "", "run": "[loading]\nV_lp = 1e-3\n", "output": f"[loading]\nV_lp = 1\n{RUN}"}
AFTER = {"loading": RUN, "run": "", "output": ""}
PROBLEMS = {"loading": LOADINGS, "run": RUNS, "output": OUTPUTS}


@pytest.mark.parametrize(
    ("table", "text", "line"),
    [(table, *row) for table, rows in PROBLEMS.items() for row in rows],
)
def test_a_problem_of_a_table_has_its_line(problems, folder, table, text, line):
    (folder / "fast.csv").write_text("t [s],V [km/s]\n0,0\n20,1000\n")
    lines = problems(f"{BEFORE[table]}[{table}]\n{text}\n{AFTER[table]}")
    beginning = ".*".join(map(re.escape, f"[{table}] {line}".split(" * ")))
    beginning = beginning.replace(r"\ \*", ".*")
    assert any(re.match(beginning, found) for found in lines), lines
    assert len(lines) == 1 or table == "loading"


def test_settings_of_a_run(read):
    text = """
        [loading]
        V_lp = 0
        [run]
        t_end = "1 min"
        V_start = "1 um/s"
        initial = { theta = "10 s", tau = "1.2 MPa" }
        times = [0.5, "1 s"]
        rtol = 1e-5
        method = "rodas5p"
        [output]
        file = "x.zarr"
        plot = "x.PNG"
    """
    scenario = read(text)
    settings = dict(scenario.settings)
    assert settings.pop("times").tolist() == [0.5, 1]
    assert same(settings.pop("loading"), Loading.constant(0))
    assert settings == {
        "t_end": 60,
        "V_start": 1e-6,
        "initial": {"theta": 10, "tau": 1.2e6},
        "rtol": 1e-5,
        "method": "rodas5p",
    }
    assert (scenario.output.file.name, scenario.output.plot.name) == ("x.zarr", "x.PNG")


def test_a_sweep_over_the_last_speed(read):
    text = "[loading]\nV_lp = 1\nsteps = [{t=1, V_lp=9}, {t=2, hold=1}]\n" + RUN
    sweep = '[sweep]\nfunction = "simulate"\nV_lp = [2, 3]'
    loading = read(text + sweep).settings["loading"]
    assert loading.V.dims == ("V_lp", "segment")
    assert loading.V.values.tolist() == [[1, 2, 0, 2], [1, 3, 0, 3]]
    sine = read("[loading]\nV_lp = 1\nsinusoid = {amplitude=1, period=5}\n" + RUN + sweep)
    assert sine.settings["loading"].mean_speed.values.tolist() == [2, 3]


def test_sweeps_that_a_loading_cannot_have(problems):
    record = "[loading]\nt = [0, 20]\nV_lp = [1, 1]\n"
    (line,) = problems(f"{record}{RUN}[sweep]\nfunction = 'simulate'\nV_lp = [1, 2]")
    assert line.startswith("[sweep] V_lp: cannot replace the speeds of a record")
    steps = "[loading]\nsteps = [{t=1, V_lp=1}]\n"
    (line,) = problems(f"{steps}{RUN}[sweep]\nfunction = 'simulate'\nV_lp = [1, 2]")
    assert line.startswith("[loading] V_lp: is missing")
    sine = "[loading]\nV_lp = 3\nsinusoid = {amplitude=2, period=1}\n"
    (line,) = problems(f"{sine}{RUN}[sweep]\nfunction = 'simulate'\nV_lp = [1, 2]")
    assert line.startswith("[loading] sinusoid: amplitude = 2 m/s is more than V_lp = 1 m/s")


def test_another_function_may_be_asked(read, problems):
    text = "[loading]\nV_lp = 1e-3\nsteps = [{t=1, V_lp=3.2e-3}]\n[run]\nt_end = 3\nrtol = 1e-3\n"
    assert read(text).function == "simulate"
    for function in ("limit_cycle", "stability"):
        scenario = read(text, function)
        assert (scenario.function, scenario.settings) == (function, {"V_lp": 3.2e-3})
    sweep = "[sweep]\nfunction = 'limit_cycle'\nrtol = 1e-9\nM = [1, 2]"
    assert read(text + sweep).settings == {"V_lp": 3.2e-3, "rtol": 1e-9}
    assert read(text + sweep, "stability").settings == {"V_lp": 3.2e-3}
    own = read(f"{text}[sweep]\nfunction = 'simulate'\nt_end = 5\nM = [1, 2]").settings
    assert (own["t_end"], own["rtol"]) == (5, 1e-3)  # [sweep] comes before [run]
    simulated = read(text + sweep, "simulate")
    assert simulated.settings.keys() == {
        "loading",
        "t_end",
    }  # both tolerances are of other functions
    assert simulated.slider.M.sizes == {"M": 2}
    lines = problems(sweep, "simulate")
    assert [line.partition(". ")[0] for line in lines] == [
        "[sweep] V_lp: is missing",
        "[sweep] t_end: is missing",
    ]
    with pytest.raises(ParameterError, match="'hopf' is unknown"):
        read(text, "hopf")


def test_the_table_run_may_name_a_function(read, problems):
    text = "[loading]\nV_lp = 1e-3\n[run]\nfunction = 'limit_cycle'\nrtol = 1e-9\n"
    scenario = read(text)
    assert (scenario.function, scenario.settings) == ("limit_cycle", {"V_lp": 1e-3, "rtol": 1e-9})
    (line,) = problems(text + "[sweep]\nfunction = 'stability'\nM = [1, 2]")
    assert line.startswith("[sweep] function: 'stability' is not the function of [run]")
    (line,) = problems(text.replace("1e-9", "1"))
    assert line.startswith("[run] rtol: 1.0 is out of range")
    sweep = "[sweep]\nfunction = 'limit_cycle'\nrtol = 1\nM = [1, 2]"
    (line,) = problems(text + sweep)  # whose rtol comes before that of [run]
    assert line.startswith("[sweep] rtol: 1.0 is out of range")


def test_an_unknown_function_leaves_nothing_else_missing(problems):
    table = '[sweep]\nfunction = "cycle"\nV_lp = ["1 um/s", "1 mm/s"]\nK = { from = "1 MPa/m" }\n'
    slider = "\n".join(line for line in SLIDER.splitlines() if not line.startswith("K ")) + "\n"
    lines = problems(table, slider=slider)
    assert [line.partition(": ")[0] for line in lines] == [
        "[sweep] function",
        "[sweep] K.to",
        "[sweep] K.n",
    ]


@pytest.mark.parametrize("function", ["limit_cycle", "stability"])
@pytest.mark.parametrize(
    ("table", "place"),
    [
        ("V_lp = 0", "V_lp"),
        ("V_lp = 1\nsteps = [{t=1, V_lp=1}, {t=2, V_lp=0}]", "steps[1].V_lp"),
        ("t = [0, 1]\nV_lp = [1, 0]", "V_lp"),
    ],
)
def test_no_cycle_at_rest(problems, function, table, place):
    (line,) = problems(f"[loading]\n{table}", function)
    assert line.startswith(
        f"[loading] {place}: a loading that ends at rest (0 m/s) has no {function}."
    )


def test_the_start_of_a_limit_cycle_is_its_own(read):
    """V_start of a file that asks for a run is the run's; a cycle has its own in [sweep]."""
    loading, start = '[loading]\nV_lp = "3 mm/s"\n', 'V_start = "1 mm/s"\n'
    axis = "b = [0.006, 0.007]\n"
    for text, given in [
        (f'[run]\nfunction = "limit_cycle"\n{start}', True),
        (f'[sweep]\nfunction = "limit_cycle"\n{axis}{start}', True),
        (f'[run]\nt_end = "1 s"\n{start}', False),
        (f'[run]\n{start}[sweep]\nfunction = "limit_cycle"\n{axis}', False),
        (f'[sweep]\nfunction = "simulate"\nt_end = "1 s"\n{axis}{start}', False),
    ]:
        scenario = read(loading + text, "limit_cycle")
        assert scenario.settings == {"V_lp": 3e-3} | ({"V_start": 1e-3} if given else {}), text


@pytest.mark.parametrize("b", [0.006, rs.logspace("b", 0.006, 0.007, 2)])
def test_a_limit_cycle_says_from_which_start(b):
    slider = rs.SpringSlider(a=0.003, b=b, Dc=1e-5, sigma=2e6, K=9e8, M=3e3)
    cycle = rs.limit_cycle(slider, 4e-3, V_start=3e-3, rtol=1e-4)
    again = loads(toml(from_result(cycle)))
    assert again.settings == {"V_lp": 4e-3, "V_start": 3e-3, "rtol": 1e-4}
    usual = from_result(rs.limit_cycle(slider, 4e-3, rtol=1e-4))
    assert usual.settings == {"V_lp": 4e-3, "rtol": 1e-4}


@pytest.mark.parametrize(
    ("symbol", "more"),
    [("b2", 'law = "two-state-slip"\nb2 = 1e-3\nDc2 = "50 um"\n'), ("damping", "damping = 1e3\n")],
)
def test_a_branch_along_what_the_slider_has(symbol, more, read, problems):
    sweep = '[sweep]\nfunction = "continue_cycle"\nV_lp = "3 mm/s"\n'
    sweep += f"{symbol} = {{ from = 2e-3, to = 1e-3 }}"
    wanted = {"parameter": symbol, "start": 2e-3, "stop": 1e-3, "V_lp": 3e-3}
    assert read(sweep, slider=SLIDER + more).settings == wanted
    (line,) = problems(sweep)
    assert line.startswith(f"[sweep] {symbol}: cannot be followed")


def test_a_sweep_of_continue_cycle_gives_parameter_start_and_stop(read, problems):
    sweep = '[sweep]\nfunction = "continue_cycle"\nV_lp = "3 mm/s"\nK = { from = 7e8, to = 3e8 }'
    scenario = read(sweep)
    assert scenario.function == "continue_cycle"
    assert scenario.settings == {"parameter": "K", "start": 7e8, "stop": 3e8, "V_lp": 3e-3}
    branch = '[sweep]\nfunction = "continue_cycle"\n'
    along = read(f"{branch}rtol = 1e-6\nV_lp = {{ from = 1e-3, to = 5e-3 }}")
    assert along.settings.keys() == {"parameter", "start", "stop", "rtol"}
    for table, line in [
        ("V_lp = 1", "[sweep]: nothing between two ends"),
        ("V_lp = {from=1, to=2}\nK = {from=1, to=2}", "[sweep]: V_lp and K between two ends"),
        ("V_lp = {from=1, to=2, n=3}", "[sweep] V_lp: 'n': a branch chooses its points itself"),
        ("V_lp = {from=1}", "[sweep] V_lp.to: is missing"),
        ("V_lp = {from=1, to=1}", "[sweep] V_lp: start = 1.0 equals stop"),
        ("mu0 = {from=1, to=2}\nV_lp = 1", "[sweep] mu0: cannot be followed"),
        ("law = {from=1, to=2}\nV_lp = 1", "[sweep] law: cannot be followed"),
        ("K = {from=1, to=2}", "[sweep] V_lp: is missing"),
        ("V_lp = {from=1, to=2}\nrtol = 1", "[sweep] rtol: 1.0 is out of range"),
    ]:
        lines = problems(branch + table)
        assert any(found.startswith(line) for found in lines), lines


def test_a_rigid_spring_cannot_rest(problems, read):
    slider = SLIDER.replace('"900 MPa/m"', "inf")
    steps = "[loading]\nV_lp = 1e-3\nsteps = [{t=5, hold=1}]\n[run]\nt_end = "
    (line,) = problems(f"{steps}10", slider=slider)
    assert line.startswith(
        "[slider] K: inf makes the slider move with the load point, which comes to re"
    )
    assert read(f"{steps}4", slider=slider).function == "simulate"
    with pytest.raises(ParameterError, match="K = inf"):  # as the function itself would say
        rs.simulate(rs.SpringSlider(a=1, b=1, Dc=1, sigma=1, K=np.inf), Loading.steps(1, (1, 0)), 2)


def test_files_have_a_largest_size(problems, folder):
    keys = "\n".join(f"k{i} = 1" for i in range(5000))
    assert len(problems(f"[loading]\nV_lp = 1\n[run]\nt_end = 1\n{keys}")) == 1
    many = ", ".join(["{ t = 1, V_lp = 1 }"] * 1001)
    (line,) = problems(f"[loading]\nV_lp = 1\nsteps = [{many}]\n{RUN}")
    assert "a list of 1001 is not a list of 1 to 1000 steps" in line
    path = folder / "large.toml"
    with path.open("wb") as file:
        file.truncate(10**8)
    with pytest.raises(
        ParameterError, match=r"it has 100000000 bytes, more than 10000000 \(put long .*\)"
    ):
        load(path)
    path.write_text("a" + ".a" * 100_000 + " = 1")
    with pytest.raises(ParameterError, match="line 1 has a key of more than 50 parts"):
        load(path)
    with pytest.raises(ParameterError, match="cannot be read: it is not a file"):
        load("/dev/zero")
    with pytest.raises(ParameterError, match="cannot be read: no such name"):
        load("a\0b")


def test_at_most_a_hundred_problems_are_listed(folder):
    path = folder / "many.toml"
    path.write_text("[slider]\n" + "\n".join(f"k{i} = 1" for i in range(500)))
    with pytest.raises(ParameterError) as caught:
        load(path)
    lines = str(caught.value).splitlines()
    assert len(lines) == 102
    assert lines[-1] == "and 407 problems more"  # of 500 keys, and 7 that are missing
    with path.open("a") as file:  # what is noted after the hundredth is no less a problem
        file.write("\n[loading]\nV_lp = 1\nsteps = [{ V_lp = 2 }]\n[run]\nt_end = 3\n")
    with pytest.raises(ParameterError, match="and 406 problems more"):
        load(path)


def test_a_problem_names_its_line(read):
    text = """
[loading]  # of the machine
V_lp = "3 mm/s"
steps = [
    { t = "1 s", V_lp = "2 m" },
]
"plot" = 1

[ run ]
rtol = 3
t_end = "3 m"
"""
    with pytest.raises(ParameterError) as caught:
        read(text, slider=SLIDER.replace("K = ", "# K = ").lstrip())
    numbers = [line.partition(": ")[0] for line in str(caught.value).splitlines()[1:]]
    assert numbers == [
        "line 1, [slider] K",
        "line 11, [loading] steps[0].V_lp",
        "line 14, [loading] plot",
        "line 17, [run] rtol",
        "line 18, [run] t_end",
    ]
