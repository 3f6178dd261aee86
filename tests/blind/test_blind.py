"""A fixed fast subset of the blind set, with shorter recordings; it may not fall below its line."""

from __future__ import annotations

import pytest

from tests.blind.diagnosing import by_command_line
from tests.blind.run_case import run_case
from tests.blind.specs import Spec

#: Right answers of the subset, at least; raise it with the diagnosis, never lower it.
LINE = 0.75

_SEED = 11
_LENGTH = 0.4
_SUBSET = (
    Spec("single", "backlash", "clear", 0),
    Spec("single", "coulomb_friction", "middle", 0),
    Spec("single", "dead_time", "clear", 0),
    Spec("single", "torque_saturation", "clear", 0),
    Spec("single", "sensor_gain", "middle", 0),
    Spec("single", "mount_mode", "clear", 0),
    Spec("single", "tyre_compliance", "clear", 0),
    Spec("single", "shaft_hysteresis", "clear", 0),
    Spec("pair", "any", "clear", 1),
    Spec("none", "none", "none", 0),
    Spec("outside", "outside:fixed_tone", "clear", 0),
    Spec("mismatch", "parameter_mismatch", "any", 0),
)


@pytest.mark.slow
def test_the_fast_subset_is_above_its_line():
    scores = [run_case(_SEED, spec, by_command_line, None, _LENGTH) for spec in _SUBSET]
    wrong = [
        f"{s.key}: {s.failure or (s.verdict, s.named)}, hidden {s.hidden}" for s in scores if not s.right
    ]
    assert all(not s.failure for s in scores), wrong
    assert len(wrong) <= (1.0 - LINE) * len(scores), "\n".join(wrong)
    nothing = next(s for s in scores if s.group == "none")
    assert not nothing.named, "an effect was named where there is none"
