"""`hil export`: a recording or a model for other tools."""

from __future__ import annotations

from pathlib import Path

from hil.app.feedback import warn_of_damage
from hil.app.result_file import reading_of
from hil.app.results_folder import refuse_file, results_in
from hil.app.run_inputs import command_again, inputs_of
from hil.cli.options.runs import Export
from hil.cli.output import TERMINAL, console, print_json, warn
from hil.core.controller import load_controller
from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.core.files.shipped import shipped_file
from hil.core.model import load_model
from hil.core.recording import (
    FRAME_LOGS,
    Recording,
    column_map,
    read_recording,
    write_frames,
    write_recording,
    written_with,
)
from hil.fmu import export_fmu


def execute(options: Export) -> int:
    """Execute the command; its exit code."""
    out = options.out
    if out.suffix.lower() == ".fmu":
        return _fmu(options)
    if options.recording.suffix.lower() == ".toml":
        raise BadInputError(
            f"a model becomes an FMU, and '{out.name}' is none",
            where="--out",
            fix="give a name that ends in .fmu",
        )
    if options.controller is not None:
        raise BadInputError(
            "--controller goes with an FMU", where="--controller", fix="leave it out, or write --out NAME.fmu"
        )
    if options.inputs:
        return _inputs(options.recording, out, overwrite=options.overwrite, as_json=options.as_json)
    for file in written_with(out):
        refuse_file(file, [options.recording], overwrite=options.overwrite)
    table = read_recording(options.recording, any_replay=True, columns=column_map(options.columns))
    warn_of_damage(TERMINAL, [table])
    if options.frames or out.suffix.lower() in FRAME_LOGS:
        return _frames(table, out, as_json=options.as_json)
    write_recording(table, out)
    if options.as_json:
        print_json(
            {
                "file": str(out),
                "samples": table.samples,
                "channels": list(table.channels),
                "damage": table.damage,
                "notes": table.notes,
                "read": reading_of([table]),
            }
        )
    else:
        for note in table.notes:
            console().print(f"note: {note}", highlight=False, markup=False, soft_wrap=True)
        console().print(f"{table.samples} samples of {len(table.channels)} channels: {out}", highlight=False)
    return 0


def _frames(table: Recording, out: Path, *, as_json: bool) -> int:
    count = write_frames(table, out)
    if as_json:
        print_json({"file": str(out), "frames": count, "damage": table.damage, "notes": table.notes})
    else:
        console().print(f"{count} raw frames: {out}", highlight=False)
    return 0


def _inputs(recording: Path, out: Path, *, overwrite: bool, as_json: bool) -> int:
    read = read_recording(recording, any_replay=True)
    files = inputs_of(read)
    with results_in(out, files, inputs=[recording], overwrite=overwrite, default="inputs") as place:
        place.write(files, [recording])
    again = command_again(read, out)
    if as_json:
        print_json({"folder": str(out), "files": sorted(files), "command": again})
    else:
        console().print(f"{', '.join(sorted(files))}: {out}", highlight=False, soft_wrap=True)
        console().print(f"run it again: {again}", highlight=False, markup=False, soft_wrap=True)
    return 0


def _fmu(options: Export) -> int:
    model = shipped_file(options.recording, "model")
    read = [model, *([options.controller] if options.controller else [])]
    refuse_file(options.out, read, overwrite=options.overwrite)
    controller = None
    if options.controller:
        controller = load_controller(options.controller), read_text(options.controller)
    chosen = load_model(model)
    if chosen.doubt:
        warn(f"the model is doubtful: {chosen.doubt}")
    export_fmu(chosen, options.out, controller)
    asked = "driving_torque_ref_nm" if controller else "motor_torque_ref_nm"
    if options.as_json:
        print_json({"file": str(options.out), "fmi": "2.0", "kind": "co-simulation", "input": asked})
        return 0
    text = f"{options.out}: FMI 2, co-simulation; input {asked}; computes where eaxle-hil is installed"
    console().print(text, highlight=False, soft_wrap=True, markup=False)
    return 0
