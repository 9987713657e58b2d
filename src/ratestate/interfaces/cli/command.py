"""Make commands out of functions; commands.toml describes their arguments and options."""

import dataclasses
import functools
import importlib
import inspect
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from ...model.names import nearest
from ...paper.figures import EXTRAS
from .exits import EXIT_CODES, exit_on_error
from .output import warnings_as_lines

Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


def _tables() -> dict[str, dict[str, Any]]:
    """Return the tables of commands.toml, with the figures beyond the paper filled in."""
    beyond = ". ".join(f"{key}: {figure.help}" for key, figure in EXTRAS.items())
    text = Path(__file__).with_name("commands.toml").read_text("utf-8")
    return tomllib.loads(text.replace("{names}", "|".join(EXTRAS)).replace("{beyond}", beyond))


_TABLES = _tables()
_SHARED = _TABLES.pop("shared")
#: group of commands -> its help, and command -> the group it is in, "" for none
GROUPS = _TABLES.pop("groups")
GROUP_OF = {name: table.pop("group", "") for name, table in _TABLES.items()}
#: the functions of the commands, in the order of the help
COMMANDS: list[Callable[..., None]] = [
    getattr(importlib.import_module(f".{table.pop('module')}", __package__), name)
    for name, table in _TABLES.items()
]


class Command(TyperCommand):
    """A command that names the option which an unknown one probably means."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        try:
            return super().parse_args(ctx, args)
        except Exception as error:  # the class is in a private module of typer
            if unknown := getattr(error, "option_name", ""):
                names = {_parameter_name(opt): opt for param in self.params for opt in param.opts}
                near = nearest(_parameter_name(unknown), names)
                error.possibilities = [names[near]] if near else []  # type: ignore[attr-defined]
            raise


def _parameter_name(option: str) -> str:
    return option.strip("-").replace("-", "_")


def as_command(function: Callable[..., None]) -> Callable[..., None]:
    """Return a function as a command, with --debug, error messages, and exit codes in its help.

    `parameters_of` gives its parameters; each is in commands.toml.
    """
    table = _SHARED | _TABLES[function.__name__]
    arguments = inspect.signature(function).parameters.values()

    @functools.wraps(function)
    def wrapped(*, context: typer.Context, debug: bool, **values: Any) -> None:
        options = {str(param.name): param.opts[0] for param in context.command.params}
        with exit_on_error(debug or bool(context.obj), options), warnings_as_lines():
            function(**{parameter.name: _argument(parameter, values) for parameter in arguments})

    kind = inspect.Parameter.KEYWORD_ONLY
    parameters = [
        *(_described(argument, **table[argument.name]) for argument in parameters_of(function)),
        inspect.Parameter("debug", kind, default=False, annotation=Debug),
        inspect.Parameter("context", kind, annotation=typer.Context),
    ]
    wrapped.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    wrapped.__doc__ = f"{_literal(inspect.getdoc(function) or '')}\n\n{EXIT_CODES}"
    return wrapped


def parameters_of(function: Callable[..., None]) -> list[inspect.Parameter]:
    """Return the parameters of a command: arguments if they are positional, else options.

    A parameter whose type is a dataclass stands for the options that are its fields.
    """
    parameters: list[inspect.Parameter] = []
    for parameter in inspect.signature(function).parameters.values():
        group = parameter.annotation
        is_group = dataclasses.is_dataclass(group)
        options = inspect.signature(group).parameters.values() if is_group else [parameter]
        parameters += options
    return parameters


def _argument(parameter: inspect.Parameter, values: dict[str, Any]) -> Any:
    """Return the argument of a function from the values of the command's parameters."""
    if not dataclasses.is_dataclass(parameter.annotation):
        return values[parameter.name]
    group: Any = parameter.annotation
    return group(**{field.name: values[field.name] for field in dataclasses.fields(group)})


def _literal(text: str) -> str:
    """Escape a text for typer, which takes a word in brackets, such as [output], for markup."""
    return re.sub(r"\[(?=[a-z#/@])", r"\\[", text)


def _described(
    parameter: inspect.Parameter, name: str = "", **description: Any
) -> inspect.Parameter:
    """Return a parameter as typer takes it; `name`: of an option that has another name."""
    if "help" in description:
        description["help"] = _literal(description["help"])
    if parameter.kind is inspect.Parameter.KEYWORD_ONLY:
        option = name or f"--{parameter.name.replace('_', '-')}"
        described: Any = typer.Option(option, **description)
    else:
        described = typer.Argument(**description)
    annotated: Any = Annotated
    annotation = annotated[parameter.annotation, described]
    return parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=annotation)
