"""What is found, stated as a diagnosis."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis import INTERRUPTED, Diagnosis, diagnose
from hil.analysis.diagnosis.asked import Asked
from hil.analysis.diagnosis.findings.assembly import diagnosis_of
from hil.analysis.missing_effects import explain_gap, series_of
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse
from hil.core.recording import Recording
from hil.plant import replay
from tests.hil.analysis.missing_effects.turning_mass import base, recording

_TORQUE_NM = 20.0


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """Coulomb friction of 1.39 N m hidden, from a base without drag: whatever brakes it closes its gap."""
    fit, held = (recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=seed) for seed in (0, 5))
    return diagnose(base(0.54, 0.0), [fit], [held])


def test_a_base_that_runs_away_gets_the_name_of_what_is_missing(found: Diagnosis) -> None:
    assert found.verdict == "named"
    assert [one.use.id for one in found.effects if one.use.id != "parameter_mismatch"] == ["coulomb_friction"]
    assert found.effects[0].use.values["torque_nm"] == pytest.approx(1.39, rel=0.05)
    assert found.effects[0].confidence > 0.9
    assert "motor_speed_rad_s" in found.effects[0].where.channels


def test_the_model_given_back_leaves_the_gap_that_is_stated(found: Diagnosis) -> None:
    """On the recording held out, which is the one that is drawn."""
    overlay = found.overlays[0]
    error = overlay.measured[:, 0] - overlay.after[:, 0]
    gap = np.sqrt(np.mean(error**2)) / np.std(overlay.measured[:, 0])
    assert gap == pytest.approx(found.holdout_after["motor_speed_rad_s"].gap, rel=1e-6)
    assert found.gap_after["motor_speed_rad_s"].gap < 0.1 * found.gap_before["motor_speed_rad_s"].gap


def test_what_was_sampled_at_another_rate_is_judged_as_it_was_sampled() -> None:
    fit, fine = (recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=seed) for seed in (0, 5))
    coarse = Recording({name: values[::5] for name, values in fine.channels.items()}, fine.source)
    found = diagnose(base(0.54, 2.17), [fit], [coarse])
    error = coarse["motor_speed_rad_s"] - replay(found.model, coarse)["motor_speed_rad_s"]
    gap = float(np.sqrt(np.mean(error**2)) / np.std(coarse["motor_speed_rad_s"]))
    assert found.holdout_after["motor_speed_rad_s"].gap == pytest.approx(gap, rel=1e-6)


def test_it_is_written_like_any_diagnosis(found: Diagnosis) -> None:
    whole = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert {"verdict", "effects", "gap", "holdout_gap", "map", "open_channels", "notes"} <= {*whole}
    optional = {one.name for one in EFFECTS["coulomb_friction"].parameters if one.optional}
    assert not optional & {name for name, v in whole["effects"][0]["parameters"].items() if v == 0.0}


def test_an_interrupt_keeps_what_the_search_found() -> None:
    fitting: list[str] = []

    def interrupt(text: str) -> None:
        fitting.append(text)
        if len(fitting) == 4:  # reading, numbers, an effect, another
            raise KeyboardInterrupt

    fit = recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=0)
    found = diagnose(base(0.54, 0.0), [fit], show=interrupt)
    assert (found.verdict, found.effects, found.unfinished) == ("unknown", (), INTERRUPTED)
    assert found.alternatives


def test_no_more_time_than_asked_for_is_taken() -> None:
    fit = recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=0)
    assert diagnose(base(0.54, 0.0), [fit], at_most_s=1e-3).unfinished


def test_an_effect_smaller_than_what_is_worth_a_name_is_a_correction() -> None:
    fit = recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=0)
    outcome = explain_gap(base(0.54, 2.17), series_of(base(0.54, 2.17), [fit]))
    named = diagnosis_of(outcome, base(0.54, 2.17), Asked({}, {}))
    small = diagnosis_of(outcome, base(0.54, 2.17), Asked({}, {"coulomb_friction": 2.0}))
    assert [one.use.id for one in named.effects] == ["coulomb_friction"]
    assert small.verdict == "none"
    assert small.effects == ()
    assert small.parameter_updates["coulomb_friction.torque_nm"][1] == pytest.approx(1.39, rel=0.02)


def test_a_class_is_stated_of_what_is_named_and_not_of_what_is_too_small() -> None:
    fit, model = recording(0.54, 2.17, 1.39, 0.0, torque_nm=_TORQUE_NM, seed=0), base(0.54, 2.17)
    outcome = explain_gap(model, series_of(model, [fit]))
    effects = [
        replace(one, alike=("viscous_drag",)) for one in outcome.effects if one.id == "coulomb_friction"
    ]
    both = [
        diagnosis_of(replace(outcome, effects=tuple(effects)), model, Asked.checked({}, least))
        for least in ({}, {"coulomb_friction": 10.0})
    ]
    assert [any("cannot tell" in note for note in one.notes) for one in both] == [True, False]
    drag = replace(effects[0], use=EffectUse("viscous_drag", {"coefficient_nms_rad": 0.1}), alike=())
    both = [
        diagnosis_of(
            replace(outcome, effects=tuple(effects), alternatives=(drag,)), model, Asked.checked({}, least)
        )
        for least in ({}, {"coulomb_friction": 10.0})
    ]
    assert [[other.use.id for other in one.alternatives] for one in both] == [["viscous_drag"], []]
