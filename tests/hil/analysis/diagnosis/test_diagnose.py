"""The whole way from recordings to names, on data of a plant with other formulas."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.diagnosis._diagnose import diagnose
from hil.core.effects import EFFECTS
from hil.core.model import Model, model_from_dict, model_to_toml
from hil.core.recording import Recording
from hil.plant import pack, system
from tests.hil.analysis import paper_plant
from tests.hil.analysis.diagnosis.reference_plant import BASE, Truth, recordings

MODEL = Model("three_inertia", dict(BASE))


#: Enough to tell the effects of these tests apart.
SOME = ("chirp_high", "steps", "reversals")


def names(found: Diagnosis) -> list[str]:
    return [e.use.id for e in found.effects]


def test_nothing_is_named_where_nothing_is_missing() -> None:
    found = diagnose(MODEL, recordings(Truth(), 1, short=True, only=SOME))
    assert (found.verdict, names(found)) == ("none", [])
    assert all(g.gap < 1.05 * g.noise_floor for g in found.gap_after.values())


@pytest.mark.parametrize(
    ("truth", "effect", "parameter", "value"),
    [
        (Truth({"torque_delay": 0.011}), "parameter_mismatch", "value", 0.011),
        pytest.param(Truth(saturation=20.0), "torque_saturation", "limit_nm", 20.0, marks=pytest.mark.slow),
        pytest.param(Truth({"coulomb": 1.0}), "coulomb_friction", "torque_nm", 1.0, marks=pytest.mark.slow),
        (Truth(offset={"motor_speed_rad_s": 1.0}), "sensor_offset", "offset", 1.0),
        pytest.param(
            Truth({"shaft_stiffness": 7000.0}), "parameter_mismatch", "value", 7000.0, marks=pytest.mark.slow
        ),
        (Truth(step={"wheel_speed_rad_s": 0.1}), "sensor_quantization", "step", 0.1),
    ],
)
def test_a_single_effect_is_named_alone(truth: Truth, effect: str, parameter: str, value: float) -> None:
    found = diagnose(MODEL, recordings(truth, 2, short=True, only=SOME))
    assert names(found) == [effect]
    assert float(found.effects[0].use.values[parameter]) == pytest.approx(value, rel=0.03)
    assert (
        all(g.gap < 1.7 * g.noise_floor for g in found.gap_after.values()) or effect == "sensor_quantization"
    )


@pytest.mark.slow
def test_two_effects_are_named_and_held_out_data_agree() -> None:
    truth = Truth({"drag": 0.01}, gain={"shaft_torque_nm": 1.06})
    all_of_them = recordings(truth, 3, short=True, only=(*SOME, "chirp_low"))
    found = diagnose(MODEL, all_of_them[:3], all_of_them[3:])
    assert sorted(names(found)) == ["sensor_gain", "viscous_drag"]
    assert all(g.gap < 1.1 * g.noise_floor for g in found.holdout_after.values())


@pytest.mark.slow
def test_an_unknown_line_is_described_and_not_named() -> None:
    found = diagnose(
        MODEL, recordings(Truth({"torque_line_hz": 13.0, "torque_line_nm": 1.0}), 4, short=True, only=SOME)
    )
    assert found.verdict == "unknown"
    assert names(found) == []
    assert "line at 13" in found.signature or "line at 12." in found.signature


def test_the_result_is_a_model_file_and_plain_json() -> None:
    found = diagnose(MODEL, recordings(Truth(saturation=20.0), 5, short=True, only=SOME))
    text = json.loads(json.dumps(found.as_json()))
    assert set(text) >= {
        "verdict",
        "effects",
        "parameter_updates",
        "alternatives",
        "gap",
        "holdout_gap",
        "model",
    }
    assert text["effects"][0]["confidence"] > 0.95 > 0.05 > text["something_else"]
    assert set(text["effects"][0]) == {
        "id",
        "parameters",
        "standard_error",
        "derived",
        "confidence",
        "where",
    }
    again = model_from_dict(tomllib.loads(model_to_toml(found.model)), "test")
    assert again.effects[0].id == "torque_saturation"
    assert all(EFFECTS[use.id] for use in again.effects)


TWO = {k: BASE[k] for k in ("motor_inertia", "gear_ratio", "shaft_stiffness", "shaft_damping")}
WITHOUT_TYRE = Model("two_inertia", TWO | {"vehicle_inertia": 307.4, "torque_delay": 0.0})


def from_the_papers_functions(noise: Sequence[float] | None = None) -> Recording:
    """What (14)-(16) give, each output with `noise`, or with noise of a hundredth of its rms."""
    torque = paper_plant.chirp(60.0)
    rng = np.random.default_rng(0)
    channels = {"time_s": np.arange(len(torque)) * 1e-3, "motor_torque_ref_nm": torque}
    outputs = paper_plant.simulate(torque)
    levels = noise or [0.01 * float(np.std(values)) for values in outputs.values()]
    for (name, values), level in zip(outputs.items(), levels, strict=True):
        channels[name] = values + rng.normal(0, level, len(torque))
    return Recording(channels, Path("chirp.csv"))


@pytest.mark.slow
@pytest.mark.parametrize("noise", [(0.05, 0.01, 1.0), None], ids=["of sensors", "of a hundredth"])
def test_no_one_chain_gives_the_papers_functions(noise: tuple[float, ...] | None) -> None:
    """Each of (14)-(16) was fitted by itself: a tyre mends the wheel speed and spoils the shaft torque."""
    found = diagnose(WITHOUT_TYRE, [from_the_papers_functions(noise)])
    assert found.verdict == "unknown"
    assert names(found) == []
    assert found.model == WITHOUT_TYRE
    assert found.alternatives
    assert len(found.open_channels) == 3
    assert wheel_misfit_db(WITHOUT_TYRE) > 16.0


def wheel_misfit_db(model: Model) -> float:
    """Rms over 0.05-30 Hz of the wheel speed's gain against the paper's (15), dB."""
    frequency = np.geomspace(0.05, 30.0, 300)
    a, b = system(pack(model))
    resolvent = 2j * np.pi * frequency[:, None, None] * np.eye(len(a)) - a
    wheel = np.linalg.solve(resolvent, np.broadcast_to(b[:, :1], (300, len(a), 1)))[:, 2, 0]
    true = paper_plant.response("wheel_speed_rad_s", frequency)
    return float(np.sqrt(np.mean((20 * np.log10(np.abs(wheel / true))) ** 2)))


def test_an_interrupted_search_tells_what_is_known() -> None:
    def interrupted(doing: str) -> None:
        if doing == "fitting backlash":
            raise KeyboardInterrupt

    data = recordings(Truth({"gap": 0.02}), 2, short=True, only=SOME)
    found = diagnose(MODEL, data, show=interrupted)
    assert (found.verdict, names(found), found.unfinished) == ("unknown", [], "interrupted")
    assert found.as_json()["unfinished"] == "interrupted"
    assert "stay unexplained" in found.signature


@pytest.mark.parametrize("seconds", [1e-9, 0.3])
def test_a_search_that_takes_too_long_ends_with_what_is_known(seconds: float) -> None:
    data = recordings(Truth({"gap": 0.02}), 2, short=True, only=SOME)
    found = diagnose(MODEL, data, at_most_s=seconds)
    assert (found.verdict, names(found)) == ("unknown", [])
    assert found.unfinished == found.as_json()["unfinished"]
    assert "of processor time were up" in found.unfinished
    assert all(gap.gap > 0.0 for gap in found.gap_after.values())


def test_an_interrupt_before_anything_is_known_ends_the_diagnosis() -> None:
    def interrupted(doing: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diagnose(MODEL, recordings(Truth(), 1, short=True, only=SOME), show=interrupted)


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth",
    [
        pytest.param(
            Truth(),
            id="nothing",
            marks=pytest.mark.xfail(
                strict=True, reason="`unknown`: 2 to 4 noises stay, and numbers are bent"
            ),
        ),
        pytest.param(Truth(saturation=20.0), id="saturation"),
    ],
)
def test_every_tenth_sample_tells_nearly_as_much_and_says_what_it_hides(truth: Truth) -> None:
    """Torque between samples is not known, which must neither be named nor spoil the model."""
    some = recordings(truth, 1, short=True, only=SOME)
    coarse = [replace(r, channels={name: values[::10] for name, values in r.channels.items()}) for r in some]
    found = diagnose(MODEL, coarse)
    expected = ("none", []) if truth == Truth() else ("named", ["torque_saturation"])
    assert (found.verdict, names(found)) == expected
    assert not found.worse
    assert any("sampled at 100 Hz" in note for note in found.notes)
