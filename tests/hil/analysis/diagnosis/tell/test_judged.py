"""What a search found, told: gaps and effects agree with the fits."""

import numpy as np
import pytest
from scipy.signal import lfilter

from hil.analysis.diagnosis.data.noise import noise_levels
from hil.analysis.diagnosis.data.sanity import Examined
from hil.analysis.diagnosis.data.trace import trace_of
from hil.analysis.diagnosis.fit.coordinates import Hypothesis
from hil.analysis.diagnosis.fit.fit import fit
from hil.analysis.diagnosis.fit.problem import problem_of
from hil.analysis.diagnosis.search.search import begin_search, search
from hil.analysis.diagnosis.tell.given_back import NUMBERS_TRADE
from hil.analysis.diagnosis.tell.judged import Judged
from hil.analysis.diagnosis.tell.result import NamedEffect
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from tests.hil.analysis.diagnosis.one_recording import MODEL, one_problem, recorded

OFFSET = EffectUse("sensor_offset", {"channel": OUTPUTS[2], "offset": 20.0})
NOTHING_HELD = Examined([], np.full(3, np.nan), [])


def test_a_named_effect_comes_with_its_error_and_an_unknown_gap_with_its_signature() -> None:
    problem = one_problem(OFFSET)
    found = search(problem, Hypothesis(MODEL), lambda text: None)
    floor = problem.floor.copy()
    named = Judged(problem, found, "named", NOTHING_HELD).diagnosis([], ["a note"], 1.0)
    assert isinstance(named.effects[0], NamedEffect)
    assert named.effects[0].standard_error["offset"] == pytest.approx(0.1, abs=0.1)
    assert (named.signature, named.notes, named.holdout_after) == ("", ("a note",), {})
    unknown = Judged(problem, found, "unknown", NOTHING_HELD).diagnosis([], [], 1.0)
    assert unknown.effects == ()
    assert OUTPUTS[2] in unknown.signature
    assert np.array_equal(problem.floor, floor)
    assert unknown.gap_before == named.gap_before


@pytest.mark.parametrize("more", [False, True])
def test_beside_a_law_that_leaves_more_than_noise_a_wrong_number_is_a_correction(more: bool) -> None:
    """It may be what the formula of the friction misses."""
    friction = EffectUse("coulomb_friction", EFFECTS["coulomb_friction"].completed({"torque_nm": 2.0}))
    problem = one_problem(friction, *[OFFSET] * more)
    inertia = MODEL.parameters["motor_inertia"]
    base = Hypothesis(MODEL.with_parameters(motor_inertia=0.9 * inertia))
    mismatch = EffectUse("parameter_mismatch", {"parameter": "motor_inertia", "value": inertia})
    found = begin_search(problem, fit(problem, base))
    found.best = fit(problem, base.with_term(friction).with_term(mismatch), found.base.starts)
    assert found.evidence.closed(found.best) is not more
    told = Judged(problem, found, "named", NOTHING_HELD).diagnosis([], [], 1.0)
    names = [effect.use.id for effect in told.effects]
    assert names == (["coulomb_friction"] if more else ["coulomb_friction", "parameter_mismatch"])
    assert ("motor_inertia" in told.parameter_updates) is more
    assert told.model.parameters["motor_inertia"] == pytest.approx(inertia, rel=0.02)


def test_without_a_name_numbers_that_trade_one_channel_for_another_are_not_taken() -> None:
    """A torque sensor with a low-pass filter of 4 ms, which no effect is: speeds were at their noise."""
    recording, pole = recorded(seconds=8.0), np.exp(-1e-3 / 4e-3)
    recording.channels[OUTPUTS[2]] = lfilter([1.0 - pole], [1.0, -pole], recording[OUTPUTS[2]])
    traces = [trace_of(recording)]
    levels = noise_levels(traces)
    problem = problem_of(traces, levels, MODEL.parameters["gear_ratio"])
    fitted = fit(problem, Hypothesis(MODEL))
    told = Judged(problem, begin_search(problem, fitted), "unknown", NOTHING_HELD).diagnosis([], [], 1.0)
    assert NUMBERS_TRADE in told.notes
    assert told.model.parameters == MODEL.parameters
    assert (told.parameter_updates, told.worse) == ({}, ())
    assert told.gap_after == told.gap_before


def held(problem, *effects: EffectUse) -> Examined:
    """A recording held out, of an axle with `effects`."""
    return Examined([trace_of(recorded(*effects, seed=2))], problem.floor, [])


def test_none_is_not_said_while_recordings_held_out_disagree() -> None:
    """What only they show, here an offset that the fitted ones have not, is a gap like any other."""
    problem = one_problem()
    found = begin_search(problem, fit(problem, Hypothesis(MODEL)))
    calm = Judged(problem, found, "none", held(problem)).diagnosis([], [], 1.0)
    assert (calm.verdict, calm.held_out_open, calm.signature) == ("none", (), "")
    told = Judged(problem, found, "none", held(problem, OFFSET)).diagnosis([], [], 1.0)
    assert (told.verdict, told.open_channels) == ("unknown", ())
    assert OUTPUTS[2] in told.held_out_open
    assert told.signature.startswith("held-out recordings leave")


def test_a_name_beside_which_recordings_held_out_disagree_comes_with_a_note() -> None:
    problem = one_problem(OFFSET)
    found = search(problem, Hypothesis(MODEL), lambda text: None)
    more = EffectUse("sensor_offset", {"channel": OUTPUTS[0], "offset": 5.0})
    told = Judged(problem, found, "named", held(problem, OFFSET, more)).diagnosis([], [], 1.0)
    assert told.verdict == "named"
    assert OUTPUTS[0] in told.held_out_open
    assert any(note.startswith("held-out recordings leave") for note in told.notes)
