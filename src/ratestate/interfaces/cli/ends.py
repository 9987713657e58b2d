"""How commands end: exit codes, messages, and tracebacks for who asks for them."""

import atexit
import contextlib
import functools
import inspect
import os
import signal
import threading
import traceback
from collections.abc import Callable, Iterator
from typing import Annotated, Any

import typer

from ...errors import RateStateError

BUG, FAILED, SOME_FAILED, INTERRUPTED = 1, 2, 3, 130
EXIT_CODES = (
    "Exit codes: 0 done, 1 a bug in ratestate, 2 error or wrong usage, "
    "3 some cases failed or a fit carries warnings, 130 interrupted."
)
#: how typer itself ends a command
OWN = (typer.Exit, typer.Abort, typer.BadParameter)
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


def command(function: Callable[..., None]) -> Callable[..., None]:
    """A function as a command: it takes --debug, ends well, and its help has the exit codes."""

    @functools.wraps(function)
    def ended(*, context: typer.Context, debug: bool, **arguments: Any) -> None:
        with ending_well(debug or bool(context.obj)):
            function(**arguments)

    signature = inspect.signature(function)
    kind = inspect.Parameter.KEYWORD_ONLY
    more = [
        inspect.Parameter("debug", kind, default=False, annotation=Debug),
        inspect.Parameter("context", kind, annotation=typer.Context),
    ]
    own = [parameter.replace(kind=kind) for parameter in signature.parameters.values()]
    ended.__signature__ = inspect.Signature([*own, *more])  # type: ignore[attr-defined]
    ended.__doc__ = f"{inspect.getdoc(function)}\n\n{EXIT_CODES}"
    return ended


@contextlib.contextmanager
def ending_well(debug: bool) -> Iterator[None]:
    """End every error with a message on stderr and an exit code; with its traceback if asked."""
    try:
        with _at_once_if_interrupted_again():
            yield
    except OWN:
        raise
    except KeyboardInterrupt as interrupt:
        typer.echo(f"interrupted; {str(interrupt) or 'no file is half written'}", err=True)
        raise typer.Exit(INTERRUPTED) from interrupt
    except Exception as error:
        if debug:
            typer.echo(traceback.format_exc(), err=True, nl=False)
        message, code = _told(error)
        typer.echo(message, err=True)
        raise typer.Exit(code) from error


@contextlib.contextmanager
def _at_once_if_interrupted_again() -> Iterator[None]:
    """Let a second Ctrl-C end the process, whatever it is at: tidying up after the first.

    That is safe at any time: files are written beside their place and renamed.
    """

    def first(*_: object) -> None:
        signal.signal(signal.SIGINT, again)
        # once threads have ended Python drops handlers, and a signal would be the exit status
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)
        raise KeyboardInterrupt

    def again(*_: object) -> None:
        os.write(2, b"interrupted again; ended at once\n")
        os._exit(INTERRUPTED)

    usual = signal.default_int_handler
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGINT) is not usual:
        yield
        return
    signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is first:
            signal.signal(signal.SIGINT, usual)


def _told(error: Exception) -> tuple[str, int]:
    """What is said of an error, and the exit code."""
    match error:
        case RateStateError():
            return f"error: {error}", FAILED
        case OSError(filename=str(name), strerror=str(why)):
            return f"error: {name}: {why}", FAILED
        case OSError():
            return f"error: {error.strerror or error}", FAILED
        case MemoryError():
            return "error: not enough memory; ask for less at a time", FAILED
        case _:
            return (
                f"this is a bug in ratestate: {type(error).__name__}: {error}\n"
                "Please report it, with what the same command says with --debug."
            ), BUG


@contextlib.contextmanager
def leaving(what: Callable[[], str]) -> Iterator[None]:
    """Say after Ctrl-C what is left of the work."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        raise KeyboardInterrupt(what()) from interrupt
