"""How commands exit: statuses, messages, and a traceback with --debug.

`fit`, `sweep` and the commands of run_scenario exit with status 3 if some cases failed.
"""

import atexit
import contextlib
import os
import signal
import threading
import traceback
from collections.abc import Iterator, Mapping

import typer

from ...errors import ParameterError, RateStateError
from .output import print_line

BUG, FAILED, SOME_FAILED, INTERRUPTED = 1, 2, 3, 130
EXIT_CODES = (
    "Exit codes: 0 done, 1 a bug in ratestate, 2 error or wrong usage, "
    "3 some cases failed or a fit carries warnings, 130 interrupted."
)


@contextlib.contextmanager
def exit_on_error(debug: bool, options: Mapping[str, str] | None = None) -> Iterator[None]:
    """Turn every error into a message on stderr and an exit code; if `debug`, with a traceback.

    Raises `typer.Exit` with the code in its place; typer's own exceptions pass.

    options : name of a parameter -> the command's option, which a message names instead
    """
    try:
        with _second_interrupt_exits():
            yield
    except (typer.Exit, typer.Abort, typer.BadParameter):
        raise
    except KeyboardInterrupt as interrupt:
        # (a sweep says what it has stored)
        print_line(str(interrupt) or "interrupted: no unfinished file is kept", err=True)
        raise typer.Exit(INTERRUPTED) from interrupt
    except Exception as error:
        if debug:
            print_line(traceback.format_exc().rstrip("\n"), err=True)
        message, code = _message_and_status(error, options or {})
        print_line(message, err=True)
        raise typer.Exit(code) from error


@contextlib.contextmanager
def _second_interrupt_exits() -> Iterator[None]:
    """Let a second Ctrl-C end the process at once; unfinished files have temporary names."""

    def first_interrupt(*_: object) -> None:
        signal.signal(signal.SIGINT, second_interrupt)
        # when Python exits it drops handlers, and a signal would then become the exit status
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
        raise KeyboardInterrupt

    def second_interrupt(*_: object) -> None:
        os.write(2, b"interrupted again: ended at once\n")
        os._exit(INTERRUPTED)

    default = signal.default_int_handler
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not default:
        yield
        return
    signal.signal(signal.SIGINT, first_interrupt)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is first_interrupt:
            signal.signal(signal.SIGINT, default)


def _message_and_status(error: Exception, options: Mapping[str, str]) -> tuple[str, int]:
    """Return the message for an error, and the exit code."""
    match error:
        case ParameterError():
            return f"error: {error.text(options.get(error.symbol, error.symbol))}", FAILED
        case RateStateError():
            return f"error: {error}", FAILED
        case OSError(filename=str(name), strerror=str(why)):
            return f"error: {name}: {why}", FAILED
        case OSError():
            return f"error: {error.strerror or error}", FAILED
        case MemoryError():
            return "error: not enough memory. Ask for less at a time.", FAILED
        case _:
            return (
                f"this is a bug in ratestate: {type(error).__name__}: {error}\n"
                "Please report it, with what the same command says with --debug."
            ), BUG
