"""The road that a plan sets at the panel, over the serial line, on the simulated bench."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.errors import BadInputError
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine import RunRequest, load_bench, run_plan
from tests.benches_for_tests import plan

BENCHES = Path(__file__).parents[4] / "benches"
BENCH = load_bench(BENCHES / "sim_road.toml")
STEPS = """
  - set_vehicle: {friction_left: 0.05, friction_right: 1.0}
  - hold_speed: {speed_km_h: 3, duration_s: 0.1}
  - step: {segment: split, quantity: motor_torque, from_nm: 0, to_nm: 40, before_s: 0.2, after_s: 0.8}
"""


@pytest.mark.slow
def test_the_simulated_axle_drives_on_the_road_that_the_panel_confirmed(tmp_path: Path) -> None:
    outcome = run_plan(RunRequest(plan(STEPS), BENCH, tmp_path, model=load_model(BENCHES / "road_axle.toml")))
    assert outcome.error is None
    recording = read_recording(outcome.recording)
    assert recording.metadata["vehicle"] == {"friction left": "0.05", "friction right": "1"}
    (segment,) = outcome.result.segments
    assert segment.friction == 0.05
    late = recording.time_s > segment.end_s - 0.2
    left, right = (recording[f"wheel_speed_{side}_rad_s"][late] for side in ("left", "right"))
    assert np.mean(left - right) > 1.0


def test_a_road_that_no_tyre_follows_is_refused_before_the_bench_is_touched(tmp_path: Path) -> None:
    model = load_model(BENCHES / "three_inertia.toml")
    with pytest.raises(BadInputError, match="hold whatever the road is"):
        run_plan(RunRequest(plan(STEPS), BENCH, tmp_path, model=model))
    assert list(tmp_path.iterdir()) == []
