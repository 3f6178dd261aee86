"""The command line as a whole: commands, and how errors become one message and an exit code."""

from __future__ import annotations

import difflib
import importlib
import importlib.metadata
import inspect
import logging
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, Protocol, get_type_hints

import typer

from hil.app.failures import error_of
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.log import LOG
from hil.cli._completion import completion_wanted, take_named_shell
from hil.cli._multi_value_options import each_with_its_option
from hil.cli._streams import complain, tolerate_outputs
from hil.core.errors import BadInputError, BenchError, HilError

logger = logging.getLogger(__name__)

# name: one line for `hil --help`. The module hil.cli.commands.NAME (_ for -) is imported when it is used.
_COMMANDS = {
    "run": "Run a test plan on a bench and write its report.",
    "check": "Validate a plan; predict its duration, peaks and criteria.",
    "report": "Renew a report from its recording.",
    "identify": "Identify frequency responses and model parameters from recordings.",
    "design": "Design a controller for a model; show its stability margins.",
    "tune": "Optimise a controller's parameters for a plan's criteria.",
    "autotune": "Identify, diagnose, tune and confirm on a bench, in rounds, unattended.",
    "campaign": "Simulate a plan many times: vary parameters, sample vehicles, compare controllers.",
    "diagnose": "Find where a model and recordings disagree; identify the missing effect and add it.",
    "compare": "Compare runs of one plan side by side.",
    "explain": "Find model changes that reproduce target values.",
    "simulate": "Replay a recording's torque through a model.",
    "recover": "Recover a recording after a crash.",
    "verify": "Verify that reports match their recording and that no file changed.",
    "sign": "Sign a run's directory as its approver.",
    "export": "Write a recording as CSV, Parquet, MDF4 or MAT, or its frames as a CAN log.",
    "export-fmu": "Export a model with its controller as an FMI 2 FMU.",
    "replay": "Decode CAN logs of other tools to a recording and report on it.",
    "sim-bench": "Run the simulated bench in its own process, in real time.",
    "serve": "Run the bench service: run queue, REST API and live page.",
    "agent": "Drive benches of this machine for a bench service on another machine.",
    "doctor": "Check a bench's devices; report faults and remedies.",
    "monitor": "Show decoded channels and bus load live; send nothing.",
    "jog": "Turn the axle at low torque and check the sign of every sensor.",
    "reset": "Reset an emergency stop so that the bench can be armed again.",
    "list": "List plans, benches, models, effects, steps, metrics and devices.",
    "init": "Make a folder that is ready to run: plan, bench, model, controller.",
    "schema": "Print the JSON schema of plan, bench, model, controller or campaign files.",
}


class Command(Protocol):
    """Options of a command, and what it does with them. Documented by its class, as `--help` shows it."""

    def __init__(self, **options: Any) -> None: ...

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        ...


def run_command_line() -> int:
    """Carry out this process's command line; its exit code.

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
        _app_of(*_COMMANDS)(arguments, prog_name="hil")
        return 0
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_help())
        return 0
    if arguments[0] == "--version":
        print(f"hil {importlib.metadata.version('eaxle-hil')}")
        return 0
    _refuse_empty_out(arguments)
    arguments = _of_a_server(arguments)
    name = arguments[0]
    if name not in _COMMANDS:
        near = difflib.get_close_matches(name, _COMMANDS, 1)
        hint = f"did you mean '{near[0]}'?" if near else "see hil --help"
        raise BadInputError(f"there is no command '{name}'", fix=hint)
    several = getattr(_module(name), "SEVERAL", ())
    _app_of(name)(list(each_with_its_option(arguments[1:], several)), prog_name=f"hil {name}")
    return 0


def _of_a_server(arguments: list[str]) -> list[str]:
    """`hil --server URL run …` as `hil run --server URL …`.

    Raises:
        BadInputError: another command than run or campaign, or none.
    """
    option, _, url = arguments[0].partition("=")
    if option != "--server":
        return arguments
    rest = arguments[1:] if url else arguments[2:]
    url = url or (arguments[1] if len(arguments) > 1 else "")
    if not url or rest[:1] not in (["run"], ["campaign"]):
        raise BadInputError(
            "a service accepts the commands 'run' and 'campaign' only",
            where="--server",
            fix="write: hil --server URL run PLAN --bench NAME; or campaign FILE",
        )
    return [rest[0], "--server", url, *rest[1:]]


def _module(name: str) -> ModuleType:
    return importlib.import_module(f"hil.cli.commands.{name.replace('-', '_')}")


def _command(name: str) -> type[Command]:
    """The class of a command, named as it is: ExportFmu of `export-fmu`. Its fields are the options."""
    found: type[Command] = getattr(_module(name), name.title().replace("-", ""))
    return found


def _app_of(*names: str) -> typer.Typer:
    """Commands as typer has them."""
    several = len(names) > 1
    app = typer.Typer(add_completion=several, rich_markup_mode=None, pretty_exceptions_enable=False)
    settings = {"help_option_names": ["-h", "--help"]}
    for name in names:
        command = _command(name)
        app.command(name, help=command.__doc__, context_settings=settings)(_with_exit_code(command))
    return app


def _refuse_empty_out(arguments: list[str]) -> None:
    """An empty --out would be this very folder: a shell variable that is not set, most likely."""
    for option, value in zip(arguments, [*arguments[1:], None], strict=True):
        if option == "--out=" or (option == "--out" and value == ""):
            raise BadInputError("--out is empty", fix="give a directory; '.' is the current one")


_VERBOSE = Annotated[bool, typer.Option("--verbose", help="print each action on standard error")]
_LOG = Annotated[Path | None, typer.Option("--log", metavar="FILE", help="write a detailed log to FILE")]


def _with_exit_code(command: type[Command]) -> Callable[..., None]:
    """The command as a function, with the options that all have."""

    def call(*, verbose: bool, log: Path | None, **options: Any) -> None:
        LOG.send(log, verbose=verbose)
        raise SystemExit(command(**options).carry_out())

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


def _help() -> str:
    width = max(map(len, _COMMANDS))
    lines = [f"  {name:<{width}}  {text}" for name, text in _COMMANDS.items()]
    head = (
        "Usage: hil COMMAND [ARGS]...\n\nHardware-in-the-loop bench service for electric axles.\n\nCommands:"
    )
    return "\n".join(
        [head, *lines, "", "hil COMMAND --help describes a command. hil --version prints the version."]
    )


def guarded(arguments: list[str]) -> int:
    """The exit code of a command line; every error is told in one message, none as a traceback."""
    LOG.begin(arguments)
    try:
        code = _carry_out(arguments)
        logger.info("exit code %d", code)
        if LOG.faulty:
            complain("note", f"details are in {LOG.kept() or 'no log: it cannot be written'}")
        return code
    finally:
        LOG.end()


def _carry_out(arguments: list[str]) -> int:
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
