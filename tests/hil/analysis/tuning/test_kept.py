"""What a tuning keeps: no one asked for it in the plan, and it must not be paid with."""

import math
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.tuning import KEPT, Effort, Kept, front_of, tune, within_hard_limits
from hil.analysis.tuning._kept import kept_of_run, room, worse_of
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import Segment
from tests.hil.analysis.tuning.trials import FREE, LET_GO, PLAN, trial_of

KEEPING = FREE.replace(LET_GO, "")
EFFORT = Effort(starts=1, far=4, near=2, joins=2, joining=1)
LATE, MARGIN = Kept("response_time", "s"), Kept("phase_margin_deg")


def test_by_default_nothing_gets_worse_by_more_than_five_percent_and_margin_is_gained():
    trial = trial_of(KEEPING)
    found = tune(trial, seed=1, effort=EFFORT, processes=1)
    start, own = found.start.nominal, found.chosen.nominal
    assert own.worst > start.worst
    assert set(found.held_by) <= set(KEPT)
    assert found.held_by  # otherwise there would have been more to gain
    assert {one.group for one in start.figures} == set(KEPT) - {"criteria"}
    for one, value in own.figures.items():
        assert one.worse_by(start.figures[one], value) <= 0.05 + 1e-9, one.words
    assert all(own.margins[name] >= margin - 0.05 - 1e-9 for name, margin in start.margins.items())


@pytest.mark.slow
def test_without_it_the_same_search_pays_with_time():
    free, kept = (tune(trial_of(text), seed=1, effort=EFFORT, processes=1) for text in (FREE, KEEPING))
    late = Kept("response_time", "phase")
    assert free.chosen.nominal.figures[late] > 1.05 * free.start.nominal.figures[late]
    assert kept.chosen.nominal.figures[late] <= 1.05 * kept.start.nominal.figures[late]
    assert not free.better_in_every_criterion
    assert free.held_by == ()
    assert late.words in {one.words for one in free.worse}
    shares = [one.share for one in free.worse if one.words.startswith("margin")] or [
        one.share for one in free.worse
    ]
    assert free.worse[0].share == max(shares)


def test_a_slower_candidate_is_beyond_what_is_kept_but_shows_on_the_front():
    trial = trial_of(KEEPING)
    slow = trial.tried({"feed_forward_time_s": 0.15}, 0)
    assert slow.limits["keep.response_time.phase"] < 0
    assert not slow.feasible
    assert within_hard_limits(slow)
    assert (
        front_of([slow], trial.driven.criteria)[0].figures[-1] == slow.figures[Kept("response_time", "phase")]
    )
    assert set(slow.limits) <= set(trial.limits)


@pytest.mark.parametrize("name", KEPT)
def test_what_is_let_go_is_no_limit(name):
    text = KEEPING + f'[keep]\nmay_worsen = ["{name}"]\n'
    limits = trial_of(text).limits
    kept = {one.split(".")[1] for one in limits if one.startswith("keep.")}
    stability = {"sensitivity_peak", "gain_margin_db", "phase_margin_deg", "delay_margin_s"}
    assert not kept & (stability if name == "stability" else {name})
    assert len(kept) == 8 - (4 if name == "stability" else 1)


def test_a_criterion_may_be_traded_on_a_car_on_which_the_start_fails():
    """Where something fails, margin elsewhere is what it is bought with."""
    failing = trial_of(KEEPING, plan_text=PLAN.replace("upper: 400", "upper: 300"))
    assert failing.tried({}, 0).worst < 0
    assert not any(".criteria." in name for name in failing.tried({"feed_forward_time_s": 0.06}, 0).limits)


def test_room_is_what_is_left_of_the_share_in_the_direction_that_is_worse():
    start = {LATE: 0.2, MARGIN: 50.0}
    left = room({LATE: 0.205, MARGIN: 49.0}, start, 0.05, ())
    assert left == pytest.approx({"keep.response_time.s": 0.05 - 0.025, "keep.phase_margin_deg": 0.05 - 0.02})
    assert room({LATE: math.inf, MARGIN: 60.0}, start, 0.05, ("stability",)) == {
        "keep.response_time.s": -math.inf
    }


def test_what_is_worse_is_found_on_the_car_where_it_is_worst():
    before = ({LATE: 0.2, MARGIN: 50.0}, {LATE: 0.1, MARGIN: 50.0})
    after = ({LATE: 0.202, MARGIN: 55.0}, {LATE: 0.104, MARGIN: 50.01})
    (found,) = worse_of(before, after)
    assert (found.words, found.car) == ("response time, 90 %, s", 1)
    assert found.share == pytest.approx(0.04)


@pytest.mark.parametrize(("start", "value", "worse"), [(0.1, 0.4, 0.0), (0.4, 0.55, 0.1), (2.0, 2.2, 0.1)])
def test_a_steady_error_counts_from_half_a_percent_of_the_step(start, value, worse):
    assert Kept("steady_error", "s").worse_by(start, value) == pytest.approx(worse)


def test_figures_of_a_step_down_are_those_of_its_closed_form():
    time = np.arange(6001) / 1000
    since = np.maximum(time - 1.0, 0.0)
    torque = -150.0 + 450.0 * np.exp(-since / 0.1)
    request = np.where(time >= 1.0, 2.0 * np.exp(-since / 0.5), 0.0)
    recording = Recording(
        {"time_s": time, "shaft_torque_nm": torque, "motor_torque_ref_nm": request}, source=Path("made.mcap")
    )
    segment = Segment(
        id="s", start_s=0.0, step_s=1.0, end_s=6.0, quantity="driving_torque",
        reference_before=300.0, reference_after=-150.0,
    )  # fmt: skip
    found = {one.name: value for one, value in kept_of_run(recording, [segment]).items()}
    assert found["response_time"] == pytest.approx(0.1 * math.log(10), abs=1e-5)
    assert found["steady_error"] == pytest.approx(0.0, abs=1e-9)
    assert found["torque_effort"] == pytest.approx(2.0 * math.sqrt(0.25 / 5.0), rel=5e-3)
    late = segment.model_copy(update={"reference_after": -500.0})
    assert [v for one, v in kept_of_run(recording, [late]).items() if one.name == "response_time"] == [
        math.inf
    ]


def test_what_is_unknown_is_refused():
    with pytest.raises(BadInputError, match="may_worsen"):
        trial_of(KEEPING + '[keep]\nmay_worsen = ["speed"]\n')
    with pytest.raises(BadInputError, match="share_percent"):
        trial_of(KEEPING + "[keep]\nshare_percent = -1\n")


def test_what_a_car_left_out_forbids_is_backed_off_from_towards_the_start():
    """One round and no car that joins: what was found on the model itself is beyond a limit on others."""
    trial = trial_of(KEEPING.replace("dead_time_s = 0.001", "dead_time_s = 0.003"), draws=6)
    alone = Effort(starts=0, far=3, near=1, joins=0, joining=1)
    found = tune(trial, seed=1, effort=alone, processes=1)
    assert all(tried.feasible for tried in found.chosen.tried)
    nominal = tune(trial_of(KEEPING), seed=1, effort=alone, processes=1)
    assert any(not trial.tried(nominal.chosen.values, car).feasible for car in range(7))
    assert found.chosen.worst.worst >= found.start.worst.worst


LONG = PLAN.replace("after_s: 0.8", "after_s: 3")
SLOW, QUICK = {"feed_forward_time_s": 0.2}, {"feed_forward_time_s": 0.03}


def test_no_candidate_fails_what_any_device_must_do_and_the_start_does():
    trial = trial_of(plan_text=LONG + "device: {response_s: 0.3}\n")
    start, slow, quick = (trial.tried(values, 0) for values in ({}, SLOW, QUICK))
    assert start.feasible
    assert quick.feasible
    assert not slow.feasible
    beyond = [name for name, room in slow.limits.items() if room < 0.0]
    assert beyond == ["device.phase.response_time"]
    assert "device.phase.response_time" in trial.limits


def test_whrising_fails_may_not_get_worse_and_is_told():
    trial = trial_of(plan_text=LONG + "device: {response_s: 0.1}\n")
    start, slow, quick = (trial.tried(values, 0) for values in ({}, SLOW, QUICK))
    assert start.device["phase.response_time"] < 0.0
    assert start.feasible
    assert quick.feasible
    assert not slow.feasible
    found = tune(trial, seed=1, effort=Effort(starts=0, far=2, near=1, joins=0, joining=1), processes=1)
    assert found.failed_checks == ("phase.response_time",)
