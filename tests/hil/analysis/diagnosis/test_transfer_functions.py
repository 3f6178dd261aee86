"""Transfer functions against recordings: what acts before and behind them is named, the rest is located."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from scipy import signal

from hil.analysis.diagnosis import Diagnosis
from hil.analysis.diagnosis._diagnose import diagnose
from hil.analysis.diagnosis.findings.assembly import ASK_FOR_CHAIN
from hil.core.channels import INPUT, TIME
from hil.core.errors import BadInputError
from hil.core.model import Model, TransferFunction, model_from_dict, model_to_toml
from hil.core.recording import Recording
from tests.hil.analysis.diagnosis.reference_plant import BASE, CHANNELS, Truth, recordings

Array = npt.NDArray[np.float64]

FINE = 10  # parts of a sample in which the axle is computed
NOISE = (0.15, 0.02, 1.5)


def axle() -> tuple[Array, Array, Array, Array]:
    """The equations of motion of the reference plant's base."""
    jm, n, k, c, jw, kt, ct, jv = (BASE[name] for name in list(BASE)[:8])
    # rotor, wheel, vehicle, twist of the shafts, twist of the tyre
    a = np.array(
        [
            [-c / n**2 / jm, c / n / jm, 0.0, -k / n / jm, 0.0],
            [c / n / jw, -(c + ct) / jw, ct / jw, k / jw, -kt / jw],
            [0.0, ct / jv, -ct / jv, 0.0, kt / jv],
            [1.0 / n, -1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, -1.0, 0.0, 0.0],
        ]
    )
    b = np.array([[1.0 / jm], [0.0], [0.0], [0.0], [0.0]])
    outputs = np.array([[1.0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0], [c / n, -c, 0, k, 0]])
    return a, b, outputs, np.zeros((3, 1))


def functions() -> dict[str, TransferFunction]:
    """What `axle` does to the acting torque."""
    numerators, denominator = signal.ss2tf(*axle())
    denominator[-1] = 0.0  # the axle turns freely: rounding left a pole beside 0
    numerators[2, -1] = 0.0
    return {
        name: TransferFunction(tuple(top), tuple(denominator), BASE["torque_delay"])
        for name, top in zip(CHANNELS, numerators, strict=True)
    }


MODEL = Model("transfer_function", transfer_functions=functions())


@dataclass(frozen=True)
class Hidden:
    """What acts before and behind the axle, besides the model's dead time."""

    later_s: float = 0.0
    lag_s: float = 0.0
    limit_nm: float = math.inf
    gain: dict[str, float] = field(default_factory=dict)
    skew_s: dict[str, float] = field(default_factory=dict)

    def recording(self, name: str, torque: Array, seed: int) -> Recording:
        """What a bench with it records, computed by scipy."""
        step = 1e-3 / FINE
        fine = np.repeat(np.clip(torque, -self.limit_nm, self.limit_nm), FINE)
        fine = delayed(fine, BASE["torque_delay"] + self.later_s, step)
        if self.lag_s:
            fine = held(first_order(self.lag_s), fine, step)[:, 0]
        shown = held(axle(), fine, step)
        rng = np.random.default_rng(seed)
        channels: dict[str, Array] = {TIME: np.arange(len(torque)) / 1e3, INPUT: torque}
        for values, channel, noise in zip(shown.T, CHANNELS, NOISE, strict=True):
            seen = delayed(values, self.skew_s.get(channel, 0.0), step)[::FINE] * self.gain.get(channel, 1.0)
            channels[channel] = seen + rng.normal(0.0, noise, len(seen))
        return Recording(channels, Path(f"{name}.csv"))


def first_order(lag_s: float) -> tuple[Array, Array, Array, Array]:
    a = np.array([[-1.0 / lag_s]])
    return a, -a, np.eye(1), np.zeros((1, 1))


def delayed(values: Array, late_s: float, step_s: float) -> Array:
    late = round(late_s / step_s)
    return np.concatenate([np.zeros(late), values])[: len(values)]


def held(system: tuple[Array, Array, Array, Array], torque: Array, step_s: float) -> Array:
    """Outputs of a system for a torque that is held from step to step."""
    matrices = signal.cont2discrete(system, step_s)
    return np.asarray(signal.dlsim(matrices, torque)[1])


def torques() -> dict[str, Array]:
    """A chirp, and stairs."""
    time = 1e-3 * np.arange(15_000)
    rise = math.log(30.0 / 0.2) / time[-1]
    chirp = 30.0 * np.sin(2.0 * math.pi * 0.2 * np.expm1(rise * time) / rise)
    return {"chirp": chirp, "stairs": np.repeat([0.0, 20.0, -15.0, 30.0, 10.0], 2000)}


def found_with(hidden: Hidden) -> Diagnosis:
    return diagnose(MODEL, [hidden.recording(name, torque, 1) for name, torque in torques().items()])


def test_nothing_is_named_where_nothing_is_missing() -> None:
    found = found_with(Hidden())
    assert (found.verdict, found.effects) == ("none", ())
    assert all(gap.gap < 1.1 * gap.noise_floor for gap in found.gap_after.values())


@pytest.mark.parametrize(
    ("hidden", "effect", "parameter", "value"),
    [
        (Hidden(later_s=0.003), "dead_time", "extra_delay_s", 0.003),
        pytest.param(Hidden(lag_s=0.008), "actuator_lag", "time_constant_s", 0.008, marks=pytest.mark.slow),
        pytest.param(Hidden(limit_nm=20.0), "torque_saturation", "limit_nm", 20.0, marks=pytest.mark.slow),
        pytest.param(Hidden(gain={CHANNELS[2]: 1.06}), "sensor_gain", "gain", 1.06, marks=pytest.mark.slow),
        pytest.param(
            Hidden(skew_s={CHANNELS[0]: 0.004}), "channel_skew", "delay_s", 0.004, marks=pytest.mark.slow
        ),
    ],
)
def test_what_acts_before_and_behind_them_is_named(
    hidden: Hidden, effect: str, parameter: str, value: float
) -> None:
    found = found_with(hidden)
    assert (found.verdict, [e.use.id for e in found.effects]) == ("named", [effect])
    assert float(found.effects[0].use.values[parameter]) == pytest.approx(value, rel=0.03)
    assert ASK_FOR_CHAIN not in found.notes
    again = model_from_dict(tomllib.loads(model_to_toml(found.model)), "model.toml")
    assert again.effects[0].id == effect  # corrections too small for a name may stand behind it


def test_what_is_missing_inside_the_axle_is_located_and_asks_for_the_chain() -> None:
    found = diagnose(MODEL, recordings(Truth({"gap": 0.02}), 2, short=True, only=("reversals",)))
    assert (found.verdict, found.effects) == ("unknown", ())
    assert "stay unexplained" in found.signature
    assert ASK_FOR_CHAIN in found.notes


def test_outputs_without_a_function_are_left_out_and_said() -> None:
    motor = {CHANNELS[0]: MODEL.transfer_functions[CHANNELS[0]]}
    found = diagnose(
        replace(MODEL, transfer_functions=motor), [Hidden().recording("chirp", torques()["chirp"], 1)]
    )
    assert found.verdict == "none"
    assert list(found.gap_after) == [CHANNELS[0]]
    assert any("no function for wheel_speed_rad_s, shaft_torque_nm" in note for note in found.notes)


def test_recordings_without_any_output_of_the_model_are_refused() -> None:
    shaft = replace(MODEL, transfer_functions={CHANNELS[2]: MODEL.transfer_functions[CHANNELS[2]]})
    recording = Hidden().recording("chirp", torques()["chirp"], 1)
    speeds = replace(recording, channels={n: v for n, v in recording.channels.items() if n != CHANNELS[2]})
    with pytest.raises(BadInputError, match="no function for any of its outputs"):
        diagnose(shaft, [speeds])
