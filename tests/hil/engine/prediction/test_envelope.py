"""What somebody consents to: never beyond the bench's limits, and watched in each run."""

import pytest

from hil.core.errors import BadInputError, BenchError
from hil.engine import RunRequest, run_plan
from hil.engine.prediction.forecast import envelope_of
from tests.benches_for_tests import SIM, plan

PEAKS = {"motor_torque_nm": 40.0, "shaft_torque_left_nm": 500.0, "motor_speed_rad_s": 0.0}
CHIRP = "from_hz: 1, to_hz: 9, duration_s: 1, fade_s: 0.2, amplitude_nm: 20"


def test_it_lies_around_what_is_predicted_and_within_the_benchs_limits():
    found = envelope_of(SIM, PEAKS, 20, 60.0, {})
    assert found.largest == {"motor_torque_nm": 52.0, "shaft_torque_left_nm": 600.0}
    assert found.bench_time_s == 1500.0
    assert "at most 20 runs and 25 min" in found.in_words()
    assert "motor_torque_nm 52 N m" in found.in_words()


def test_what_somebody_states_takes_its_place():
    found = envelope_of(SIM, PEAKS, 3, 60.0, {"motor_torque_nm": 41.0, "bench_time_s": 200.0})
    assert (found.largest["motor_torque_nm"], found.bench_time_s) == (41.0, 200.0)


def test_what_is_beyond_it_is_named():
    found = envelope_of(SIM, PEAKS, 3, 60.0, {})
    assert found.beyond(PEAKS) == ""
    assert found.beyond({**PEAKS, "motor_torque_nm": 52.5}) == "motor_torque_nm 52.5 of 52 N m"


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"motor_torque": 50.0}, "limits no 'motor_torque'"),
        ({"motor_torque_nm": 151.0}, "up to the bench's 150"),
        ({"motor_torque_nm": -1.0}, "above 0"),
        ({"motor_torque_nm": float("nan")}, "above 0"),
        ({"motor_torque_nm": 39.0}, "would leave the envelope: motor_torque_nm 40 of 39 N m"),
        ({"bench_time_s": 59.0}, "one run takes 60 s"),
    ],
)
def test_one_that_makes_no_sense_or_leaves_no_room_is_refused(asked, said):
    with pytest.raises(BadInputError, match=said):
        envelope_of(SIM, PEAKS, 3, 60.0, asked)


@pytest.mark.parametrize(("largest", "trips"), [(30.0, False), (15.0, True)])
def test_a_run_that_leaves_it_trips(tmp_path, largest, trips):
    envelope = envelope_of(SIM, {"motor_torque_nm": 10.0}, 1, 1.0, {"motor_torque_nm": largest})
    steps = f"[chirp: {{segment: c, quantity: motor_torque, {CHIRP}}}]"
    outcome = run_plan(RunRequest(plan(steps), envelope.watched_on(SIM), tmp_path))
    assert isinstance(outcome.error, BenchError) is trips
    assert outcome.result.safe_state == "confirmed"
    if trips:
        assert "the limit is 15 N m" in str(outcome.error)
