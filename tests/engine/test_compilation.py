"""Kernels of laws: what is said when they are compiled, and another process that does it."""

import subprocess
import sys

import pytest
from numba.core.compiler import Flags
from textbook import OF_LAW
from user_laws import MINE, PLAIN

import ratestate as rs
from ratestate.dynamics.cycles.compilation import any_return, compile_cycles_elsewhere
from ratestate.engine import compilation, jit
from ratestate.engine.return_map import march_to_section
from ratestate.errors import ParameterError
from ratestate.friction.composition import composed
from ratestate.friction.laws import LAWS

FIRST = "ratestate: compiling the solver for this machine, once, about 10 s\n"
SLIP, AGING = LAWS["slip"], LAWS["aging"]
ANOTHER = "ratestate: compiling another part of the solver for this machine, once, about 10 s\n"


@pytest.fixture(autouse=True)
def new_process(tmp_path, monkeypatch):
    """An empty cache, and a process that has compiled nothing."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for name, value in (("_called", set()), ("_announced", set()), ("_elsewhere", {})):
        monkeypatch.setattr(compilation, name, value)


def rate(law, w):
    return law.rates(0.5, w, (0.25,), (3.0,), (2.0,))[0]


def doubled(law, w):
    return 2.0 * law.rates(0.5, w, (0.25,), (3.0,), (2.0,))[0]


def test_a_kernel_has_the_formulas_of_its_law():
    kernel = jit.kernel(rate)
    for law in (SLIP, AGING):
        assert compilation.call(kernel, law, 2.0) == rate(law, 2.0)
    assert rate(SLIP, 2.0) == -1.5
    assert rate(AGING, 2.0) == 1.0
    assert len(kernel.signatures) == 2


def test_it_is_said_once_for_each_part_that_is_not_on_disk(capfd):
    one, other = jit.kernel(rate), jit.kernel(doubled)
    for kernel, law in ((one, SLIP), (one, SLIP), (one, AGING), (other, SLIP)):
        compilation.announce(kernel, law)
        compilation.call(kernel, law, 2.0)
    assert capfd.readouterr().err == FIRST + ANOTHER + ANOTHER
    compilation._called.clear()
    compilation._announced.clear()
    for law in (SLIP, AGING):
        compilation.announce(one, law)  # on disk
    assert capfd.readouterr().err == ""
    compilation.announce(other, AGING)
    assert capfd.readouterr().err == ANOTHER  # "once" was said by the process that was first


def test_nothing_is_said_without_the_compiler(capfd):
    compilation.announce(rate, SLIP)  # as `jit.kernel` leaves it then
    assert compilation.call(rate, SLIP, 2.0) == -1.5
    assert capfd.readouterr().err == ""


class Other:
    """A process that compiles a kernel, once it is waited for, and says that it was."""

    def __init__(self, command, **streams):
        self.command, self.waits, self.kernel = command, 0, None

    def wait(self):
        self.waits += 1
        if self.kernel:
            self.kernel(SLIP, 2.0)

    def kill(self):
        pass


def test_another_process_is_waited_for(monkeypatch, capfd):
    monkeypatch.setattr(subprocess, "Popen", Other)
    kernel = jit.kernel(rate)
    compilation.compile_elsewhere(kernel, SLIP, "pass")
    compilation.compile_elsewhere(kernel, SLIP, "pass")
    (other,) = compilation._elsewhere.values()
    assert other.command == [sys.executable, "-P", "-c", "pass"]
    assert (other.waits, capfd.readouterr().err) == (0, "")
    other.kernel = jit.kernel(rate)
    compilation.announce(kernel, AGING)  # is compiled here
    compilation.announce(kernel, SLIP)
    assert (other.waits, compilation._elsewhere) == (1, {})
    assert capfd.readouterr().err == FIRST  # for both: they are compiled at the same time
    assert kernel._cache.kept(SLIP)
    compilation.compile_elsewhere(kernel, SLIP, "pass")
    assert compilation._elsewhere == {}


def test_where_the_other_process_fails_the_call_compiles(monkeypatch, capfd):
    kernel = jit.kernel(rate)
    compilation.compile_elsewhere(kernel, SLIP, "raise SystemExit(1)")
    compilation.announce(kernel, SLIP)
    assert compilation.call(kernel, SLIP, 2.0) == -1.5
    assert capfd.readouterr().err == FIRST

    def refuses(*command, **streams):
        raise PermissionError

    monkeypatch.setattr(subprocess, "Popen", refuses)
    compilation.compile_elsewhere(kernel, AGING, "pass")
    assert compilation._elsewhere == {}


@pytest.mark.parametrize("law", LAWS)
def test_the_statement_calls_what_a_limit_cycle_needs(law, monkeypatch):
    monkeypatch.undo()  # with the kernels that are compiled
    before = set(compilation._called)
    friction = composed(LAWS[law])
    compilation._called.discard((march_to_section, friction))
    exec(any_return(friction.name), {})
    assert (march_to_section, friction) in compilation._called
    compiled = len(march_to_section.signatures)
    common = {"a": 0.01, "b": 0.02, "Dc": 1e-5, "sigma": 1e7, "K": 5e9, "M": 1e3}
    rs.limit_cycle(rs.SpringSlider(**common, law=law, **OF_LAW[law]), 1e-3)
    assert len(march_to_section.signatures) == compiled
    compilation._called.update(before)


def test_a_users_law_is_made_known_elsewhere(law_file):
    """From the text of its file; a class has none."""
    name, made = rs.register(law_file(MINE)), {}
    assert f"known_again({MINE!r})" in any_return(name)
    exec(PLAIN, made)
    assert any_return(rs.register(made["Plain"])) == ""


def test_what_is_compiled_elsewhere_is_of_a_known_law(monkeypatch):
    asked = []
    place = "ratestate.dynamics.cycles.compilation.compile_elsewhere"
    monkeypatch.setattr(place, lambda *given: asked.append(given))
    compile_cycles_elsewhere("Dieterich")
    kernel, law, statement = asked[0]
    assert (kernel, law) == (march_to_section, AGING)
    assert "system_of('aging', " in statement
    with pytest.raises(ParameterError, match="law = 'nope' is unknown"):
        compile_cycles_elsewhere("nope")


def test_flags_are_compared_as_numba_does():
    """Our equality and hash of flags, beside those that they stand for."""
    flags = [Flags() for _ in range(5)]
    flags[1].nrt = True
    flags[2].nrt = False  # the default, set by hand
    flags[3].forceinline = True
    flags[4].nrt, flags[4].forceinline = True, True
    values = [{name: getattr(one, name) for name in one.options} for one in flags]
    for one, its in zip(flags, values, strict=True):
        assert compilation._hash_of_flags(one) == hash(tuple(sorted(its)))
        for other, others in zip(flags, values, strict=True):
            assert compilation._equal_flags(one, other) == (its == others)
    assert compilation._equal_flags(flags[0], 1) is NotImplemented
    assert compilation._equal_flags(flags[0], flags[2]) is True
    assert compilation._equal_flags(flags[0], flags[1]) is False
