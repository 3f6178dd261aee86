"""The command line as a whole: commands, and how errors become one message and an exit code."""

from __future__ import annotations

import importlib
import importlib.metadata
import inspect
import logging
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from hil.app.interrupts import EXIT_CODE, INTERRUPTS, error_of
from hil.app.log import LOG
from hil.cli._commands import (
    GROUPS,
    RENAMED,
    command_names,
    execute,
    group_help,
    help_text,
    options_of,
    taken_apart,
)
from hil.cli.completion import completion_wanted, take_named_shell
from hil.cli.streams import complain, tolerate_outputs
from hil.core.errors import BadInputError, BenchError, HilError

logger = logging.getLogger(__name__)


def run_command_line() -> int:
    """Execute this process's command line; its exit code.

    Errors become one message on standard error. A standard output that could not be written is a failure
    of its own; one whose reader has gone is not.
    """
    out, _ = tolerate_outputs()
    code = guarded(sys.argv[1:])
    sys.stdout.flush()
    if out.failure is not None:
        reason = out.failure.strerror or str(out.failure)
        complain("error", f"standard output: {reason}\n  free disk space, or redirect the output")
        code = code or BenchError.exit_code
    sys.stderr.flush()
    return code


def _dispatch(arguments: list[str]) -> int:
    if completion_wanted(arguments):
        take_named_shell(arguments)
        app_of(*command_names())(arguments, prog_name="hil")
        return 0
    if not arguments or arguments[0] in ("-h", "--help"):
        print(help_text())
        return 0
    if arguments[0] == "--version":
        print(f"hil {importlib.metadata.version('eaxle-hil')}")
        return 0
    _refuse_empty_out(arguments)
    arguments = _of_a_server(arguments)
    name, rest = taken_apart(arguments)
    if name in GROUPS:
        print(group_help(name))
        return 0
    if arguments[0] in RENAMED:
        complain("note", f"'hil {arguments[0]}' is now 'hil {name}'; the old name goes with the next release")
    several = getattr(options_of(name), "SEVERAL", ())
    app_of(name)(list(each_with_its_option(rest, several)), prog_name=f"hil {name}")
    return 0


def _of_a_server(arguments: list[str]) -> list[str]:
    """`hil --server URL run …` as `hil run --server URL …`.

    Raises:
        BadInputError: another command than run, campaign or list, or none.
    """
    option, _, url = arguments[0].partition("=")
    if option != "--server":
        return arguments
    rest = arguments[1:] if url else arguments[2:]
    url = url or (arguments[1] if len(arguments) > 1 else "")
    if not url or rest[:1] not in (["run"], ["campaign"], ["list"]):
        raise BadInputError(
            "a service accepts the commands 'run', 'campaign' and 'list runs' only",
            where="--server",
            fix="write: hil --server URL run PLAN --bench NAME; or campaign FILE; or list runs",
        )
    return [rest[0], "--server", url, *rest[1:]]


def app_of(*names: str) -> typer.Typer:
    """Commands as typer has them: one alone, or all with their groups."""
    several = len(names) > 1
    app = _typer(add_completion=several)
    groups: dict[str, typer.Typer] = {}
    for name in names:
        group, _, last = name.rpartition(" ")
        if several and group not in groups:
            groups[group] = _typer() if group else app
            if group:
                app.add_typer(groups[group], name=group)
        options = options_of(name)
        settings = {"help_option_names": ["-h", "--help"]}
        add = (groups[group] if several else app).command(
            last, help=options.__doc__, context_settings=settings
        )
        add(_with_exit_code(name, options))
    return app


def _typer(*, add_completion: bool = False) -> typer.Typer:
    return typer.Typer(add_completion=add_completion, rich_markup_mode=None, pretty_exceptions_enable=False)


def _refuse_empty_out(arguments: list[str]) -> None:
    """An empty --out would be this very folder: a shell variable that is not set, most likely."""
    for option, value in zip(arguments, [*arguments[1:], None], strict=True):
        if option == "--out=" or (option == "--out" and value == ""):
            raise BadInputError("--out is empty", fix="give a directory; '.' is the current one")


_VERBOSE = Annotated[bool, typer.Option("--verbose", help="print each action on standard error")]
_LOG = Annotated[Path | None, typer.Option("--log", metavar="FILE", help="write a detailed log to FILE")]


def _with_exit_code(name: str, command: type[Any]) -> Callable[..., None]:
    """The command as a function, with the options that all have."""

    def call(*, verbose: bool, log: Path | None, **options: Any) -> None:
        LOG.send(log, verbose=verbose)
        raise SystemExit(execute(name, command(**options)))

    common = {"verbose": (False, _VERBOSE), "log": (None, _LOG)}
    kinds = {
        **get_type_hints(command, include_extras=True),
        **{name: kind for name, (_, kind) in common.items()},
    }
    own = [
        parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=kinds[name])
        for name, parameter in inspect.signature(command).parameters.items()  # those of its fields
    ]
    ours = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
        for name, (default, kind) in common.items()
    ]
    call.__signature__ = inspect.Signature([*own, *ours])  # type: ignore[attr-defined]
    call.__annotations__ = kinds
    return call


def guarded(arguments: list[str]) -> int:
    """The exit code of a command line; every error is reported in one message, none as a traceback."""
    LOG.begin(arguments)
    try:
        code = _execute(arguments)
        logger.info("exit code %d", code)
        if LOG.faulty:
            complain("note", f"details are in {LOG.kept() or 'no log: it cannot be written'}")
        return code
    finally:
        LOG.end()


def _execute(arguments: list[str]) -> int:
    try:
        return _dispatch(arguments)
    except SystemExit as stop:
        if stop.code == EXIT_CODE and INTERRUPTS.arrived:  # typer answers Ctrl-C on its own, in silence
            INTERRUPTS.tell()
        return stop.code if isinstance(stop.code, int) else 0
    except KeyboardInterrupt:
        return _interrupted()
    except Exception as error:
        internal = not isinstance(error, HilError | OSError | ModuleNotFoundError | MemoryError)
        return _interrupted() if internal and INTERRUPTS.arrived else _complained(error_of(error))


def _interrupted() -> int:
    sys.stdout.flush()
    INTERRUPTS.tell()
    return EXIT_CODE


def _complained(error: HilError) -> int:
    complain("error", str(error))
    return error.exit_code


def each_with_its_option(arguments: Iterable[str], several: Iterable[str]) -> Iterator[str]:
    """The arguments with an option of `several` before each of its values, which end at the next option."""
    names = tuple(several)
    option, first, plain = "", False, False
    for argument in arguments:
        if plain or argument == "--":
            plain, option = True, ""
        elif argument in names:
            option, first = argument, True
            yield option
            continue
        elif argument.startswith("-") and argument != "-":
            option = ""
        elif option and first:
            first = False
        elif option:
            yield option
        yield argument
