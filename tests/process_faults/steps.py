"""Steps of a package of its own that say on the disk which phase of a run begins."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar

from hil.core.recording import Recording
from test_plans import Conductor, Outlook, Pace, Step

ENTRY_POINTS = """\
[hil.steps]
enter = tests.process_faults.steps:Enter
muse = tests.process_faults.steps:Muse
"""
ENTERED = ".entered"


class Enter(Step):
    """Adds a line to a file of the phase: one in the rehearsal before the run, one in the run."""

    kind: ClassVar[str] = "enter"
    phase: str

    def execute(self, conductor: Conductor) -> None:
        with Path(f"{self.phase}{ENTERED}".replace(" ", "-")).open("a") as file:
            file.write(f"{time.time()}\n")

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.0, speed_m_s)


class Muse(Step):
    """An analysis that takes its time."""

    kind: ClassVar[str] = "muse"
    for_s: float

    def execute(self, conductor: Conductor) -> None:
        conductor.analyse("muse", self._work, ("thoughts.txt",))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        time.sleep(self.for_s)
        return {"thoughts.txt": b"none"}
