"""Peak: the largest value."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics._metric import ChannelName
from test_plans.metrics._window import WindowMetric


class Peak(WindowMetric):
    """Largest value of a channel in the window."""

    name: ClassVar[str] = "peak"

    @property
    def definition(self) -> str:
        """Largest value in the window."""
        return f"Largest value of {self.subject} {self.window}."

    def compute(self, recording: Recording, segment: Segment) -> float:
        """The largest sample."""
        _, values = self.samples(recording, segment)
        return float(np.max(values))


class PeakShaftTorque(Peak):
    """Peak of T_s after the step."""

    name: ClassVar[str] = "peak_shaft_torque"
    channel: ChannelName = "shaft_torque_nm"
