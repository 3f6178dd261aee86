"""`hil simulate`: what a model says to a recording's torque."""

from __future__ import annotations

from hil.app.feedback import warn_of_damage
from hil.app.result_file import reading_of
from hil.app.results_folder import refuse_file
from hil.cli.options.models import Simulate
from hil.cli.output import TERMINAL, console, print_json, warn
from hil.core.model import load_model
from hil.core.recording import column_map, read_recording, write_recording
from hil.plant import replay


def execute(options: Simulate) -> int:
    """Execute the command; its exit code."""
    out = options.out
    refuse_file(out, [options.source, options.model], overwrite=options.overwrite)
    chosen = load_model(options.model)
    if chosen.doubt:
        warn(f"the model is doubtful: {chosen.doubt}")
    recording = read_recording(options.source, columns=column_map(options.columns))
    warn_of_damage(TERMINAL, [recording])
    simulated = replay(chosen, recording)
    notes = [*recording.notes, *simulated.notes]
    write_recording(simulated, out)
    if options.as_json:
        print_json(
            {
                "file": str(out),
                "samples": len(simulated.time_s),
                "channels": list(simulated.channels),
                "notes": notes,
                "read": reading_of([recording]),
            }
        )
        return 0
    for note in notes:
        console().print(f"note: {note}", highlight=False, markup=False, soft_wrap=True)
    console().print(f"{len(simulated.time_s)} samples: {out}", highlight=False)
    return 0
