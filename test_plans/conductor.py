"""What a step may ask of a bench: the one interface between plans and the engine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from hil.core.recording import Recording
from hil.core.vehicle import VehicleAndRoad

Array = npt.NDArray[np.float64]
Quantity = Literal["motor_torque", "driving_torque"]


@dataclass(frozen=True)
class PlannedSegment:
    """A named stretch of samples, before it has a place in a recording.

    `step_s` and `end_s` are seconds from the first sample of the stretch; `reference_before` and
    `reference_after` are values of `quantity` in N m, before and after the step, which takes `rise_s`. Where
    the torque changes before the step, as in stairs, `first_change_s` is when it first does.
    """

    id: str
    kind: str
    step_s: float
    reference_before: float
    reference_after: float
    quantity: Quantity = "driving_torque"
    end_s: float = math.inf
    rise_s: float = 0.0
    first_change_s: float | None = None


#: What an analysis step does: from the run's recording so far (its segments in the attachment `run.json`) and
#: the directory with what earlier analyses made, to new files by name.
Work = Callable[[Recording, Path], Mapping[str, bytes]]


#: An operator who has not answered by then ends the run, unless the step says otherwise, s.
PROMPT_TIMEOUT_S = 600.0


class Conductor(Protocol):
    """Executes what steps ask for; the engine implements it. Every call blocks until done."""

    #: Distance of the samples given to `play`, seconds.
    sample_time_s: float

    def set_controller(self, file: Path) -> None:
        """Write a controller file's parameters to the RMCU and read them back.

        A relative path names a file that an analysis of this run has made.
        """
        ...

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        """Ramp the dynos to a vehicle speed and hold it; `duration_s` counts from when it is reached."""
        ...

    def set_slip(self, slip: float) -> None:
        """Have the dynos' vehicle slip by this share of its wheels' speed, from 0 to below 1."""
        ...

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """Set vehicle and road load at the dynos' panel and read them back."""
        ...

    def release_vehicle(self) -> None:
        """From now on the dynos simulate the vehicle, from the present speed."""
        ...

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """Request `samples_nm` (N m, one-dimensional, held for `sample_time_s` each), as a segment."""
        ...

    def coast(self, duration_s: float) -> None:
        """Request zero torque."""
        ...

    def wait(self, duration_s: float) -> None:
        """Leave everything as it is."""
        ...

    def prompt(self, text: str, timeout_s: float = PROMPT_TIMEOUT_S, picture: str = "") -> None:
        """Show `text` to the operator and wait for the answer; none within `timeout_s` ends the run.

        `picture` names a file beside the plan that is shown with it where pictures can be; '' for none.
        """
        ...

    def ramp_down(self, duration_s: float) -> None:
        """Bring torque and speed to zero."""
        ...

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        """Let `work` look at the recording so far and keep the files it returns; `makes` announces them."""
        ...
