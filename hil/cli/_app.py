"""The command line as a whole: commands, and how errors become one message and an exit code."""

from __future__ import annotations

import difflib
import functools
import importlib
import os
import sys
from collections.abc import Callable
from typing import Any

import typer

from hil.core.errors import BadInputError, BenchError, HilError, InterruptError

# name: (module, one line for `hil --help`). Modules are imported when their command is used.
_COMMANDS = {
    "run": ("hil.cli.run", "Run a test plan on a bench, and report."),
    "check": ("hil.cli.check", "Validate a plan, estimate its duration, predict its peaks."),
    "report": ("hil.cli.report", "Make the report again from a recording."),
    "identify": ("hil.cli.identify", "Frequency responses and fits from recordings."),
    "design": ("hil.cli.design", "Controller from a model, with margins."),
    "diagnose": ("hil.cli.diagnose", "Find where model and measurement disagree, name the effect, add it."),
    "simulate": ("hil.cli.simulate", "Replay a recording's torque through a model."),
    "export": ("hil.cli.export", "Write a recording as CSV, Parquet or MDF4."),
    "schema": ("hil.cli.schema", "JSON schema of plan files, for editors."),
}


def main() -> None:
    """Run the command line of this process and exit with its code."""
    sys.exit(_guarded(sys.argv[1:]))


def _dispatch(arguments: list[str]) -> int:
    if not arguments or arguments[0] in ("-h", "--help"):
        print(_help())
        return 0 if arguments else 2
    name = arguments[0]
    if name not in _COMMANDS:
        near = difflib.get_close_matches(name, _COMMANDS, 1)
        hint = f"did you mean '{near[0]}'?" if near else "see hil --help"
        raise BadInputError(f"there is no command '{name}'", fix=hint)
    command = importlib.import_module(_COMMANDS[name][0]).command
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    settings = {"help_option_names": ["-h", "--help"]}
    app.command(name, help=command.__doc__, context_settings=settings)(_with_exit_code(command))
    app(arguments[1:], prog_name=f"hil {name}")
    return 0


def _with_exit_code(command: Callable[..., int]) -> Callable[..., None]:
    @functools.wraps(command)
    def call(*args: Any, **kwargs: Any) -> None:
        try:
            code = command(*args, **kwargs)
        except KeyboardInterrupt:
            raise InterruptError("interrupted") from None
        sys.stdout.flush()
        raise SystemExit(code)

    return call


def _help() -> str:
    width = max(map(len, _COMMANDS))
    lines = [f"  {name:<{width}}  {text}" for name, (_, text) in _COMMANDS.items()]
    head = (
        "Usage: hil COMMAND [ARGS]...\n\nHardware-in-the-loop bench service for electric axles.\n\nCommands:"
    )
    return "\n".join([head, *lines, "", "hil COMMAND --help tells about one of them."])


def _guarded(arguments: list[str]) -> int:
    try:
        return _dispatch(arguments)
    except HilError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"error: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return BenchError.exit_code
