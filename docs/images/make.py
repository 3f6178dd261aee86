"""Makes the pictures of the README from an acceptance run and an autotune: `make figures`."""

import json
import shutil
import sys
import tempfile
from pathlib import Path

from hil.core.recording import read_recording
from reports import write_figures
from reports.diagnosis_figures import GapBars, GapRow
from reports.labels import Label, channel_label
from test_plans import rejudged

WANTED = ("steps-20kmh-shaft-torque-enlarged", "steps-20kmh-motor-speed-spectrum")


def main(recording: Path) -> None:
    """Write the wanted figures of `recording` beside this file."""
    measured = read_recording(recording)
    with tempfile.TemporaryDirectory() as directory:
        made = write_figures(measured, rejudged(measured), Path(directory))
        for name in WANTED:
            shutil.copy(made[name], Path(__file__).parent / f"{name}.svg")


def gap(diagnosis: Path) -> None:
    """The gap between model and bench before and after, of a `diagnosis.json`."""
    gaps = json.loads(diagnosis.read_text("utf-8"))["gap"]
    rows = tuple(
        GapRow(
            channel_label(name).text, *(100.0 * gaps[name][key] for key in ("before", "after", "noise_floor"))
        )
        for name in gaps
    )
    bars = GapBars("autotune-gap", Label("How far simulation and measurement are apart"), rows)
    (Path(__file__).parent / "autotune-gap.svg").write_bytes(bars.as_svg())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
    gap(Path(sys.argv[2]))
