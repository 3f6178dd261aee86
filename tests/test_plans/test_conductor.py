from __future__ import annotations

import math

from test_plans import Conductor, PlannedSegment
from tests.test_plans.note_taker import NoteTaker


def test_a_conductor_is_what_has_its_methods() -> None:
    conductor: Conductor = NoteTaker()
    assert conductor.sample_time_s == 0.001


def test_a_segment_needs_five_facts() -> None:
    segment = PlannedSegment("up", "step", 1.0, 0.0, 326.0)
    assert segment.quantity == "driving_torque"
    assert math.isinf(segment.end_s)
