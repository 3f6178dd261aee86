"""The command line as a whole: commands, and how errors become one message and an exit code."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable
from typing import Any

import click
import typer
import typer.core

from hil.core.errors import HilError, InterruptError

# name: (module, one line for `hil --help`). Modules are imported when their command is used.
_COMMANDS = {
    "run": ("hil.cli.run", "Run a test plan on a bench, and report."),
    "check": ("hil.cli.check", "Validate a plan, estimate its duration, predict its peaks."),
    "report": ("hil.cli.report", "Make the report again from a recording."),
    "identify": ("hil.cli.identify", "Frequency responses and fits from recordings."),
    "design": ("hil.cli.design", "Controller from a model, with margins."),
    "simulate": ("hil.cli.simulate", "Replay a recording's torque through a model."),
    "export": ("hil.cli.export", "Write a recording as CSV, Parquet or MDF4."),
    "schema": ("hil.cli.schema", "JSON schema of plan files, for editors."),
}


class _LazyGroup(click.Group):
    """Imports a command's module only when it is asked for: `hil --help` answers at once."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        del ctx
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        del ctx
        entry = _COMMANDS.get(cmd_name)
        if entry is None:
            return None
        module = importlib.import_module(entry[0])
        app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
        app.command(cmd_name, help=module.command.__doc__)(module.command)
        command: Any = typer.main.get_command(app)
        return command  # type: ignore[no-any-return]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        del ctx
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in _COMMANDS.items()])


_app = _LazyGroup(
    "hil",
    help="Hardware-in-the-loop bench service for electric axles.",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line of this process and exit with its code."""
    sys.exit(_guarded(lambda: _app.main(prog_name="hil", standalone_mode=False)))


def _guarded(call: Callable[[], Any]) -> int:
    try:
        code = call()
        sys.stdout.flush()
    except HilError as error:
        _say(str(error))
        return error.exit_code
    except click.exceptions.Abort:
        _say("interrupted")
        return InterruptError.exit_code
    except KeyboardInterrupt:
        _say("interrupted")
        return InterruptError.exit_code
    except click.ClickException as error:
        error.show()
        return 2
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        _say(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
        return 3
    return code if isinstance(code, int) else 0


def _say(text: str) -> None:
    print(f"error: {text}", file=sys.stderr)
