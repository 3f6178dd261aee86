"""`hil report`: the report again, from a recording alone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.commands._options import Columns


@dataclass(frozen=True, kw_only=True)
class Report:
    """Renew a report from its recording; compute the criteria again from the channels.

    Beside its own recording a report is renewed in place. A recording that another tool made gets a report
    of its channels, without verdict.
    """

    source: Annotated[
        Path, typer.Argument(metavar="DIR_OR_RECORDING", help="a run's directory, or a recording")
    ]
    out: Annotated[Path | None, typer.Option(help="where to write; default: beside the recording")] = None
    columns: Columns = None
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="replace the reports of another recording")
    ] = False
    as_json: Annotated[bool, typer.Option("--json", help="print the result on stdout, nothing else")] = False

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        from hil.cli.report import carry_out

        return carry_out(self)
