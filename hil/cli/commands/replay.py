"""`hil replay`: CAN logs of other tools, decoded to a recording."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.app.worker.lean_imports import import_python_can
from hil.cli.commands._options import Columns

SEVERAL = ("--dbc", "--bus")


@dataclass(frozen=True, kw_only=True)
class Replay:
    """Decode CAN logs to a recording and report on it: recording.mcap, report.html, report.pdf.

    With --plan the criteria are judged: result.json and junit.xml too. Several logs are put on one clock by
    their absolute stamps. What is left out of a log is said.
    """

    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LOG...", help=".mcap, .asc, .blf, .trc, .log (candump) or .mf4 (bus logging)"
        ),
    ]
    bench: Annotated[
        str | None,
        typer.Option(help="bench file, or the name of a shipped bench: its devices decode the frames"),
    ] = None
    dbc: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[CHANNEL=]FILE",
            help="instead of --bench: DBC whose signals become channels; CHANNEL of the log, default: all",
        ),
    ] = None
    bus: Annotated[
        list[str] | None,
        typer.Option(
            metavar="BUS=CHANNEL", help="assign a channel of the log to a bus, where it is ambiguous"
        ),
    ] = None
    plan: Annotated[
        str | None, typer.Option(help="plan whose criteria are evaluated; needs the times of its segments")
    ] = None
    segments: Annotated[
        Path | None,
        typer.Option(help="the run's recording.mcap, or JSON with segments; default: those of a .mcap LOG"),
    ] = None
    stamps: Annotated[
        str,
        typer.Option(
            help="where stamps of a log go back: append (what follows was recorded later) or sort "
            "(it was written out of order); those of an ASC's trigger blocks: log (they count from the log's "
            "begin) or block (from each block's date); default: a log that leaves it open is refused"
        ),
    ] = ""
    shift: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LOG=SECONDS",
            help="move the clock of one of several logs, as of a tool that wrote another time zone",
        ),
    ] = None
    columns: Columns = None
    operator: Annotated[
        str, typer.Option(help="name of the person who ran the bench; printed in the report")
    ] = ""
    out: Annotated[
        Path | None, typer.Option(help="directory; default: a new one, out/replay-001 and so on")
    ] = None
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace earlier results in --out")] = False
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )

    def carry_out(self) -> int:
        """Carry the command out; its exit code."""
        import_python_can()
        from hil.cli.replay import carry_out

        return carry_out(self)
