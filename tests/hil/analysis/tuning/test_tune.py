"""A whole tuning of a short plan: better than its start, the same again, and plain where it cannot be."""

import dataclasses
import itertools
from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.tuning import Effort, Tuning, front_of, refuse_model, tune
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model
from tests.hil.analysis.tuning.trials import FREE, MODEL, trial_of

QUICK = Effort(starts=1, far=2, near=1, joins=2, joining=1)


def test_the_worst_margin_grows_on_every_car_and_the_front_holds_what_none_beats():
    trial = trial_of(draws=3)
    found = tune(trial, seed=1, effort=QUICK, processes=1)
    assert found.start.worst.worst < found.chosen.worst.worst
    assert found.chosen.worst.worst == min(tried.worst for tried in found.chosen.tried)
    assert len(found.chosen.tried) == 4
    assert found.chosen.nominal.binding in {c.id for c in trial.driven.criteria}
    assert {len(row) for row in found.sensitivities.values()} == {2}
    best = [point.figures for point in front_of(found.archive, trial.driven.criteria)]
    assert best
    assert all(a == b or any(x < y for x, y in zip(a, b, strict=True)) for a in best for b in best)


@pytest.mark.slow
def test_two_processes_find_what_one_finds():
    trial = trial_of(draws=2)
    found, again = (tune(trial, seed=1, effort=QUICK, processes=count) for count in (1, 2))
    assert dict(again.chosen.values) == dict(found.chosen.values)
    assert [t.margins for t in again.chosen.tried] == [t.margins for t in found.chosen.tried]


def test_a_search_that_is_stopped_keeps_the_best_so_far():
    asked = itertools.count()
    found = tune(trial_of(), effort=QUICK, processes=1, stopped=lambda: next(asked) > 1)
    assert found.ended == "stopped"
    assert found.chosen.worst.worst >= found.start.worst.worst


def test_a_search_on_cars_that_is_stopped_compares_on_those_that_it_had_got_to():
    seen: list[str] = []
    trial = trial_of(draws=6)
    found = tune(
        trial,
        effort=Effort(starts=0, far=2, near=1, joins=6, joining=2),
        processes=1,
        show=lambda text, share: seen.append(text),
        stopped=lambda: any("near, 3 cars:" in text for text in seen),
    )
    assert found.ended == "stopped"
    for one in (found.chosen, found.start):
        assert [tried.draw for tried in one.tried] == [0, 1, 2]
    assert [draw.number for draw in found.trial.draws] == [0, 1, 2]
    assert found.trial.draws[0].model == MODEL
    assert {draw.seed for draw in found.trial.draws} < {draw.seed for draw in trial.draws}
    again = found.trial.tried(found.chosen.values, 2)
    assert again.margins == found.chosen.tried[2].margins
    assert found.chosen.worst.worst >= found.start.worst.worst


def test_a_start_that_keeps_the_limits_is_the_best_so_far_where_nothing_else_does():
    asked = itertools.count()
    flat = "[free]\nlead_deg = [0.0, 0.1]\n[limits]\nsensitivity_peak = {}\n"

    def stopped(largest: float) -> Tuning:
        trial = trial_of(flat.format(largest))
        return tune(trial, effort=QUICK, processes=1, stopped=lambda: next(asked) > 1)

    found = stopped(2.0)
    assert found.chosen.controller.wsc == found.trial.start.wsc
    assert found.chosen.worst.feasible
    with pytest.raises(BadInputError, match="stopped before a controller was found"):
        stopped(1.01)


def test_no_candidate_that_was_tried_beats_the_chosen_in_every_criterion():
    found = tune(trial_of(), seed=2, effort=QUICK, processes=1)
    own = found.chosen.nominal.margins
    rivals = [tried.margins for tried in found.archive if tried.feasible]
    assert len(rivals) > 20
    assert not any(all(rival[name] > own[name] for name in own) for rival in rivals)


def test_cars_join_until_no_car_is_worse_than_those_that_were_searched_on():
    trial = trial_of(draws=6)
    effort = Effort(starts=0, far=2, near=1, joins=6, joining=3)
    seen: list[str] = []
    shares: list[float] = []

    def show(text: str, share: float | None) -> None:
        seen.append(text)
        shares.append(-1.0 if share is None else share)

    found = tune(trial, effort=effort, processes=1, show=show)
    assert shares[:-1] == sorted(shares[:-1])  # how much is done never falls; the last is the comparison
    assert 0.0 <= shares[0] <= max(shares) < 1.0
    assert found.ended == "converged"
    assert any("4 cars" in text for text in seen)
    assert found.chosen.worst.worst >= found.start.worst.worst


def test_hard_limits_that_nothing_keeps_are_said():
    limited = trial_of(FREE + "[limits]\nmotor_torque_nm = 20\n")
    with pytest.raises(BadInputError, match="motor_torque_nm by"):
        tune(limited, effort=QUICK, processes=1)


def test_an_unstable_start_is_refused():
    late = MODEL.with_effects(EffectUse("dead_time", {"extra_delay_s": 0.05}))
    with pytest.raises(BadInputError, match="unstable on this model"):
        tune(trial_of(model=late), effort=QUICK, processes=1)


@pytest.mark.parametrize(
    ("model", "said"),
    [
        (
            dataclasses.replace(MODEL, meta={"warning": "misses 40 %"}),
            "does not explain its recordings: misses",
        ),
        (dataclasses.replace(MODEL, meta={"explains_the_data": False}), "does not explain the data"),
        (Model("transfer_function"), "no shaft to load"),
    ],
)
def test_a_model_that_nothing_should_be_tuned_on_is_refused(model, said):
    with pytest.raises(BadInputError, match=said):
        refuse_model(model, "m.toml")


def test_a_weight_makes_a_margin_count_less_and_a_lack_more():
    plain, heavy = trial_of(), trial_of(FREE + "[weights]\npeak_shaft_torque = 4\n")
    own, weighted = (t.tried({"feed_forward_time_s": 0.03}, 0).margins for t in (plain, heavy))
    for name, margin in own.items():
        factor = (0.25 if margin > 0 else 4) if "peak_shaft_torque" in name else 1
        assert weighted[name] == pytest.approx(factor * margin)


def test_no_criterion_loses_margin_where_none_may():
    trial = trial_of(FREE + "[limits]\nno_worse_than_start = true\n")
    own = trial.tried({}, 0).margins
    slower = trial.tried({"feed_forward_time_s": 0.15}, 0)
    least = min(slower.margins[name] - own[name] for name in own)
    assert slower.limits["no_worse_than_start"] == pytest.approx(least)
    assert slower.feasible == (least >= 0)
    found = tune(trial, seed=1, effort=QUICK, processes=1)
    assert all(found.chosen.nominal.margins[name] >= own[name] for name in own)


def test_what_somebody_consented_to_is_a_hard_limit_of_the_whole_run() -> None:
    trial, channel = trial_of(), "motor_torque_ref_nm"
    trial = replace(trial, execute=replace(trial.execute, channels=trial.execute.channels | {channel}))
    run = trial.execute(MODEL, trial.start, 0.0, 0)
    most_nm = float(np.max(np.abs(run.recording[channel])))
    for allowed_nm, is_kept in ((1.02 * most_nm, True), (1.005 * most_nm, False)):  # noise needs some room
        within = replace(trial, envelope={channel: allowed_nm})
        assert f"envelope.{channel}" in within.limits
        tried = within.tried({}, 0)
        assert tried.limits[f"envelope.{channel}"] == pytest.approx(0.99 - most_nm / allowed_nm)
        assert tried.feasible == is_kept
