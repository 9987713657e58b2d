"""Work spread over processes."""

import os

import pytest
from child_work import dies_elsewhere, ends_oddly, prints, refuses, squared

from ratestate import machine
from ratestate.records.kit import processes
from ratestate.records.kit.processes import mapped


@pytest.fixture(autouse=True)
def two_cores(monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: 2)


def test_results_are_in_order_and_from_both_processes():
    done = []
    results = mapped(squared, range(60), done.append)
    assert [square for square, _ in results] == [i * i for i in range(60)]
    processes = {process for _, process in results}
    assert len(processes) == 2
    assert os.getpid() in processes
    assert done == sorted(done)
    assert 0 < done[0] <= done[-1] <= 60


def test_few_items_are_computed_in_this_process():
    assert {process for _, process in mapped(squared, range(3))} == {os.getpid()}
    assert mapped(squared, []) == []


def test_the_work_of_a_dead_child_is_done_here():
    items = [(i, os.getpid()) for i in range(12)]
    assert mapped(dies_elsewhere, items) == [*range(12)]


def test_without_processes_the_work_is_done_here(monkeypatch):
    def no_process(*_, **__):
        raise OSError("none to be had")

    monkeypatch.setattr(machine.subprocess, "Popen", no_process)
    assert {process for _, process in mapped(squared, range(8))} == {os.getpid()}


def test_an_error_in_a_child_process_is_raised():
    with pytest.raises(ValueError, match="no 3"):
        mapped(refuses, range(40))


def test_printing_does_no_harm(capfd):
    assert mapped(prints, range(40)) == [*range(40)]
    assert "printed" in capfd.readouterr().out


def test_no_child_is_left(monkeypatch):
    children = []
    start = machine.subprocess.Popen

    def recorded(*arguments, **options):
        children.append(start(*arguments, **options))
        return children[-1]

    monkeypatch.setattr(machine.subprocess, "Popen", recorded)
    mapped(squared, range(10))
    with pytest.raises(ValueError, match="no 3"):
        mapped(refuses, range(10))
    assert len(children) == 2
    assert all(child.poll() is not None for child in children)


def test_how_a_child_ended_is_reported():
    with machine.Child(ends_oddly) as child:
        with pytest.raises(machine.ChildDied):
            child.call("exit")
        assert child.ending() == "exit code 5"


def test_an_exception_that_pickle_cannot_rebuild_keeps_its_text():
    with machine.Child(ends_oddly) as child, pytest.raises(RuntimeError, match="TwoTexts: first"):
        child.call("raise")
