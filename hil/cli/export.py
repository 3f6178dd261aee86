"""`hil export`: a recording for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._output import console, print_json, warn_of_damage
from hil.cli._place import refuse_file
from hil.core.recording import read_recording, write_recording


def command(
    recording: Annotated[Path, typer.Argument(help=".mcap, .csv, .parquet or .mf4")],
    out: Annotated[Path, typer.Option(help="file to write: .csv, .parquet or .mf4")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the file in --out")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Write a recording's channels as CSV, Parquet or MDF4; what was lost of them is said."""
    refuse_file(out, [recording], overwrite=overwrite)
    table = read_recording(recording)
    warn_of_damage([table])
    write_recording(table, out)
    if as_json:
        print_json(
            {
                "file": str(out),
                "samples": len(table.time_s),
                "channels": list(table.channels),
                "damage": table.damage,
                "notes": table.notes,
            }
        )
    else:
        for note in table.notes:
            console().print(f"note: {note}", highlight=False)
        console().print(
            f"{len(table.time_s)} samples of {len(table.channels)} channels: {out}", highlight=False
        )
    return 0
