"""How people ask: the `hil` command. Commands, outputs and exit codes: docs/reference/commands.md."""

from hil.cli._app import main

__all__ = ["main"]
