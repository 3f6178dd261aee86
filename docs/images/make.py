"""Makes the pictures of the README from an acceptance run: `make figures`."""

import shutil
import sys
import tempfile
from pathlib import Path

from hil.core.recording import read_recording
from reports import write_figures
from test_plans import rejudged

WANTED = ("steps-20kmh-shaft-torque-enlarged", "steps-20kmh-motor-speed-spectrum")


def main(recording: Path) -> None:
    """Write the wanted figures of `recording` beside this file."""
    measured = read_recording(recording)
    with tempfile.TemporaryDirectory() as directory:
        made = write_figures(measured, rejudged(measured), Path(directory))
        for name in WANTED:
            shutil.copy(made[name], Path(__file__).parent / f"{name}.svg")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
