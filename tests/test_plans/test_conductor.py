from __future__ import annotations

import math

from hil.engine.run.preflight import Rehearsal
from test_plans import Conductor, PlannedSegment
from tests.benches_for_tests import SIM
from tests.test_plans.note_taker import NoteTaker


def test_a_conductor_is_what_has_its_methods() -> None:
    conductor: Conductor = NoteTaker()
    assert conductor.sample_time_s == 0.001
    promised = {name for name in vars(Conductor) if not name.startswith("_")}
    promised |= set(Conductor.__annotations__)
    for one in (NoteTaker(), Rehearsal(SIM)):
        assert promised <= {name for name in dir(one) if not name.startswith("_")}, type(one)


def test_a_segment_needs_five_facts() -> None:
    segment = PlannedSegment("up", "step", 1.0, 0.0, 326.0)
    assert segment.quantity == "driving_torque"
    assert math.isinf(segment.end_s)
