"""`hil simulate`: what a model says to a recording's torque."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hil.cli._output import console, print_json, warn_of_damage
from hil.cli._place import refuse_file
from hil.core.model import load_model
from hil.core.recording import read_recording, write_recording
from hil.plant import replay


def command(
    model: Annotated[Path, typer.Option(help="model file")],
    source: Annotated[Path, typer.Option("--input", help="recording with motor_torque_ref_nm")],
    out: Annotated[Path, typer.Option(help="file to write: .csv, .parquet or .mf4")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace the file in --out")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="print a JSON object on stdout, nothing else")
    ] = False,
) -> int:
    """Replay a recording's motor_torque_ref_nm through a model, from the recording's initial speeds.

    The model's outputs are written at the recording's time stamps.
    """
    refuse_file(out, [source, model], overwrite=overwrite)
    chosen = load_model(model)
    recording = read_recording(source)
    warn_of_damage([recording])
    simulated = replay(chosen, recording)
    write_recording(simulated, out)
    if as_json:
        print_json(
            {
                "file": str(out),
                "samples": len(simulated.time_s),
                "channels": list(simulated.channels),
                "notes": simulated.notes,
            }
        )
        return 0
    for note in simulated.notes:
        console().print(f"note: {note}", highlight=False)
    console().print(f"{len(simulated.time_s)} samples: {out}", highlight=False)
    return 0
