"""A mistake is named where it is far likelier than none, from a base that is near or far."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import examine
from hil.analysis.diagnosis.data.mistakes import mistaken
from hil.analysis.missing_effects import proven_noise, series_of
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, parameter_names
from hil.core.recording import Recording
from hil.plant import simulate
from tests.hil.analysis import paper_plant
from tests.hil.analysis.diagnosis.one_recording import MODEL, NOISE

RPM = 60.0 / (2.0 * np.pi)
MOTOR, WHEEL, SHAFT = NAMES = ("motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm")
TORQUE = "motor_torque_ref_nm"
INERTIAS = [name for name in MODEL.parameters if name.endswith("inertia")]
HEAVY = MODEL.with_parameters(**{name: 3.0 * MODEL.parameters[name] for name in INERTIAS})
LIGHT = MODEL.with_parameters(**{name: 0.5 * MODEL.parameters[name] for name in INERTIAS})


def chirp(*effects: EffectUse, seed: int = 1) -> Recording:
    """Slow enough that both speeds turn together for a while."""
    torque = paper_plant.chirp(20.0, 0.2, 20.0, 40.0)
    rng = np.random.default_rng(seed)
    shown = simulate(MODEL.with_effects(*effects), torque, 1e-3)
    noisy = {n: shown[n] + rng.normal(0.0, level, len(torque)) for n, level in zip(NAMES, NOISE, strict=True)}
    return Recording(
        {"time_s": 1e-3 * np.arange(len(torque), dtype=float), TORQUE: torque, **noisy}, Path("one.csv")
    )


def changed(**channels: np.ndarray | float) -> Recording:
    """With channels that are replaced, or multiplied by a number."""
    one = chirp()
    new = {n: one[n] * by if isinstance(by, float) else by for n, by in channels.items()}
    return dataclasses.replace(one, channels={**one.channels, **new})


def said(recording: Recording, model: Model = MODEL) -> str:
    series = series_of(model, [recording])
    found = mistaken(model, series, proven_noise(series, {}))
    return "" if found is None else found.what


@pytest.mark.parametrize("model", [MODEL, HEAVY, LIGHT])
@pytest.mark.parametrize(
    ("factors", "what"),
    [
        ({}, ""),
        ({MOTOR: -1.0}, f"{MOTOR} looks inverted"),
        ({WHEEL: -1.0}, f"{WHEEL} looks inverted"),
        ({SHAFT: -1.0}, f"{SHAFT} looks inverted"),
        ({MOTOR: -1.0, WHEEL: -1.0}, f"{MOTOR} and {WHEEL} look inverted"),
        ({TORQUE: -1.0}, f"{TORQUE} looks inverted"),
        ({MOTOR: RPM}, f"{MOTOR} looks like rpm"),
        ({WHEEL: RPM}, f"{WHEEL} looks like rpm"),
        ({SHAFT: 1e-3}, f"{SHAFT} looks like kN m"),
        ({TORQUE: 1e-3}, f"{TORQUE} looks like kN m"),
        ({TORQUE: 1e-3, SHAFT: 1e-3}, f"{TORQUE} and {SHAFT} look like kN m"),
    ],
)
def test_a_mistake_is_named_from_any_base(factors: dict[str, float], what: str, model: Model) -> None:
    assert said(changed(**factors), model).startswith(what)
    assert bool(said(changed(**factors), model)) is bool(what)


def test_both_speeds_in_rpm_are_named_by_an_inertia_that_is_known() -> None:
    assert said(changed(**{MOTOR: RPM, WHEEL: RPM})) == f"{MOTOR} and {WHEEL} look like rpm"


def test_columns_that_are_swapped_are_named() -> None:
    one = chirp()
    assert said(changed(**{MOTOR: one[WHEEL], WHEEL: one[MOTOR]})) == f"{MOTOR} and {WHEEL} look swapped"


@pytest.mark.parametrize("factor", [0.4, 2.5])
def test_another_gear_ratio_is_named_with_both(factor: float) -> None:
    ratio = MODEL.parameters["gear_ratio"]
    text = said(changed(**{WHEEL: factor}))
    assert text.startswith("the gear ratio looks wrong: motor over wheel speed is ")
    assert float(text.split(" is ")[1].split(",")[0]) == pytest.approx(ratio / factor, rel=0.02)
    assert f"the model has {ratio:.3g}" in text


def test_another_unit_of_the_shaft_torque_is_named_with_its_factor() -> None:
    assert said(changed(**{SHAFT: 0.05})).startswith(f"{SHAFT} is 0.05")


@pytest.mark.parametrize("channel", NAMES)
def test_a_channel_of_noise_alone_is_dead_where_the_others_move(channel: str) -> None:
    level = dict(zip(NAMES, NOISE, strict=True))[channel]
    noise = np.random.default_rng(3).normal(0.0, level, 20_000)
    assert (
        said(changed(**{channel: noise})) == f"{channel} looks dead: it shows only noise while the axle moves"
    )


@pytest.mark.parametrize(
    "effect",
    [
        EffectUse("torque_saturation", {"limit_nm": 3.0}),
        EffectUse("coulomb_friction", {"torque_nm": 15.0}),
        EffectUse("backlash", {"half_gap_rad": 0.03}),
        EffectUse("dead_time", {"extra_delay_s": 0.02}),
        EffectUse("sensor_gain", {"channel": WHEEL, "gain": 1.2}),
    ],
)
def test_a_missing_effect_is_no_mistake(effect: EffectUse) -> None:
    recording = chirp(effect)
    assert [said(recording, model) for model in (MODEL, HEAVY, LIGHT)] == ["", "", ""]


@pytest.mark.parametrize("channel", [MOTOR, WHEEL])
def test_a_shaft_torque_and_a_speed_that_are_swapped_are_named(channel: str) -> None:
    one = chirp()
    text = said(changed(**{channel: one[SHAFT], SHAFT: one[channel]}))
    assert text == f"{channel} and {SHAFT} look swapped"


def test_a_speed_of_noise_is_dead_where_the_other_follows_the_model() -> None:
    """Too little motion for play and twist, and one channel without noise."""
    quiet = chirp()
    quiet.channels[WHEEL] = simulate(MODEL, quiet[TORQUE], 1e-3)[WHEEL]
    quiet.channels[MOTOR] = np.random.default_rng(3).normal(0.0, 0.05, 20_000)
    assert said(quiet) == f"{MOTOR} looks dead: it shows only noise while the axle moves"


@pytest.mark.parametrize("step", [0.5, 2.0, 20.0])
def test_a_wheel_speed_in_coarse_steps_is_not_dead(step: float) -> None:
    one = chirp()
    assert said(changed(**{WHEEL: np.round(one[WHEEL] / step) * step})) == ""


def test_of_wheels_that_turn_as_recorded_both_speeds_are_compared() -> None:
    driven = Model("two_inertia", {n: MODEL.parameters[n] for n in parameter_names("two_inertia")})
    driven = dataclasses.replace(driven, load_input=WHEEL)
    time = 1e-3 * np.arange(20_000, dtype=float)
    wheel = 10.0 * np.sin(0.5 * time) + 5.0 * np.sin(3.0 * time)
    ratio = driven.parameters["gear_ratio"]
    rng = np.random.default_rng(1)
    channels = {"time_s": time, TORQUE: 20.0 * np.sin(time), WHEEL: wheel + rng.normal(0.0, 0.02, 20_000)}
    channels[MOTOR] = ratio * wheel + rng.normal(0.0, 0.2, 20_000)
    good = Recording(channels, Path("driven.csv"))
    assert examine(driven, [good])[1] == []
    with pytest.raises(BadInputError, match="either .* looks inverted"):
        examine(driven, [Recording({**channels, MOTOR: -channels[MOTOR]}, Path("driven.csv"))])
    with pytest.raises(BadInputError, match=f"{MOTOR} looks dead: it reads 0 throughout"):
        examine(driven, [Recording({**channels, MOTOR: 0.0 * time}, Path("driven.csv"))])
