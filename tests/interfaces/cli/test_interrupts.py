"""Ctrl-C, once and again: exit code 130, a line and no traceback."""

import signal
import subprocess
import sys

import pytest

# (where SIGINT is ignored, as in the background of a shell, children inherit it)
HEAD = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
COMMAND = """
import os, sys, threading, time, typer
from ratestate.interfaces.cli.exits import exit_on_error

def work():
    try:
        print("working", flush=True)
        time.sleep(60)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(left()) from None

def left():
    if sys.argv[1] == "tidying":
        print("tidying", flush=True)
        time.sleep(60)
    return "interrupted: x"

class Late:
    def __del__(self, write=os.write, sleep=time.sleep):
        write(1, b"late\\n")
        sleep(1)

if sys.argv[1] == "thread":
    threading.Thread(target=time.sleep, args=(60,)).start()
if sys.argv[1] == "late":
    late = Late()
try:
    with exit_on_error(False):
        work()
except typer.Exit as end:
    print("exit", flush=True)
    sys.exit(end.exit_code)
"""


def started(code, *arguments):
    pipe = subprocess.PIPE
    command = [sys.executable, "-c", HEAD + code, *arguments]
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True)


def interrupted(process, after):
    assert process.stdout.readline().startswith(after)
    process.send_signal(signal.SIGINT)


def test_one_interrupt_ends_with_code_130():
    with started(COMMAND, "nothing") as process:
        interrupted(process, "working")
        assert process.wait(20) == 130
        assert process.stderr.read() == "interrupted: x\n"


@pytest.mark.parametrize(
    ("at", "after", "first"), [("tidying", "tidying", ""), ("thread", "exit", "interrupted: x\n")]
)
def test_a_second_interrupt_ends_at_once(at, after, first):
    """While it tidies up, and while threads keep the process from its end."""
    with started(COMMAND, at) as process:
        interrupted(process, "working")
        interrupted(process, after)
        assert process.wait(20) == 130
        assert process.stderr.read() == first + "interrupted again: ended at once\n"


def test_a_second_interrupt_while_python_ends():
    """Where no handler of its own is left to Python; a shell says 130 of both, a program not."""
    with started(COMMAND, "late") as process:
        interrupted(process, "working")
        assert process.stdout.readline() == "exit\n"
        interrupted(process, "late")
        assert process.wait(20) == 130
        assert process.stderr.read() == "interrupted: x\n"


def test_an_interrupt_ends_the_explorer():
    code = "from ratestate.interfaces.cli import main; main()"
    with started(code, "explore", "--port", "0", "--no-browser") as process:
        interrupted(process, "explorer at http://127.0.0.1:")
        assert process.wait(20) == 130
        assert process.stderr.read().endswith("interrupted: the explorer has ended\n")


def test_the_previous_handler_is_restored():
    code = COMMAND.replace("time.sleep(60)", "pass")
    code += "print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)"
    with started(code, "nothing") as process:
        assert process.communicate(timeout=20)[0].split() == ["working", "True"]
