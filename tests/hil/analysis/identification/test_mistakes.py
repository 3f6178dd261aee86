"""`hil identify` on channels that no axle gives: refused by name, and what is an axle after all is not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hil.analysis.frequency_response import estimate, experiments_of
from hil.analysis.identification import identify
from hil.analysis.identification._mistakes import refuse_mistakes
from hil.cli._app import guarded
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, load_model, parameter_names
from hil.core.recording import Recording
from hil.plant import Start, simulate
from tests.benches_for_tests import SIM
from tests.hil.analysis import paper_plant

AXLE = load_model(SIM.simulation.model).with_effects()
_TWO = {name: AXLE.parameters[name] for name in parameter_names("two_inertia")}
BARE = Model("two_inertia", {**_TWO, "vehicle_inertia": 5.0})
HELD = Model("two_inertia", {**_TWO, "vehicle_inertia": 2e4})
NOISE = dict(zip(OUTPUTS, (0.15, 0.02, 1.5), strict=True))
MOTOR, WHEEL, SHAFT = OUTPUTS
RPM = 60 / (2 * np.pi)
Channels = dict[str, np.ndarray]
Change = Callable[[Channels], Channels]


def chirp(
    model: Model = AXLE,
    *,
    from_hz: float = 0.1,
    speed: float = 0.0,
    noise: float = 1.0,
    seconds: float = 30.0,
) -> Channels:
    """A chirp to 30 Hz as recorded, from a wheel speed in rad/s."""
    torque = paper_plant.chirp(seconds, from_hz, 30.0, 30.0)
    start = Start(speed * model.parameters["gear_ratio"], speed, 0.0)
    seen = simulate(model, torque, 1e-3, start)
    rng = np.random.default_rng(0)
    noisy = {n: seen[n] + noise * NOISE[n] * rng.standard_normal(len(torque)) for n in OUTPUTS}
    return {TIME: np.arange(len(torque)) * 1e-3, INPUT: torque, **noisy}


def times(factor: float, *names: str) -> Change:
    return lambda c: {n: factor * v if n in names else v for n, v in c.items()}


def swapped(c: Channels) -> Channels:
    return {**c, MOTOR: c[WHEEL], WHEEL: c[MOTOR]}


def without(name: str, channels: Channels) -> Channels:
    return {n: v for n, v in channels.items() if n != name}


def checked(channels: Channels, gear_ratio: float | None = None) -> tuple[str, ...]:
    """What is doubted of a recording, before anything is fitted."""
    experiments = experiments_of(Recording(channels, Path("r.csv")))
    return refuse_mistakes(experiments, estimate(experiments), gear_ratio)


MISTAKES = [
    (swapped, f"{MOTOR} and {WHEEL} look swapped", "exchange the two columns"),
    (times(-1.0, INPUT), f"{INPUT} looks inverted", "invert the sign"),
    *((times(-1.0, n), f"{n} looks inverted", "invert the sign") for n in OUTPUTS),
    (times(-1.0, MOTOR, WHEEL), f"{MOTOR} and {WHEEL} look inverted", "invert the sign of both"),
    (times(RPM, MOTOR), f"{MOTOR} looks like rpm", "2π/60"),
    (times(RPM, WHEEL), f"{WHEEL} looks like rpm", "2π/60"),
    (times(1e-3, SHAFT), f"{SHAFT} looks like kN m", "1000"),
    (times(1e-3, INPUT), f"{INPUT} looks like kN m", "1000"),
]
RECORDINGS = {
    "from 0.1 Hz": chirp(),
    "at speed": chirp(speed=15.0),
    "from 1 Hz": chirp(from_hz=1.0),
    "without a vehicle": chirp(BARE),
    "noisy": chirp(noise=4.0),
}


@pytest.mark.parametrize(("change", "said", "fix"), MISTAKES, ids=[said for _, said, _ in MISTAKES])
@pytest.mark.parametrize("recording", RECORDINGS)
def test_a_mistake_is_refused_by_name(recording: str, change: Change, said: str, fix: str) -> None:
    with pytest.raises(BadInputError) as caught:
        checked(change(RECORDINGS[recording]))
    assert said in caught.value.what
    assert fix in caught.value.fix
    assert "r.csv" in caught.value.where


@pytest.mark.parametrize("recording", RECORDINGS)
def test_a_good_recording_is_taken_without_a_doubt(recording: str) -> None:
    for left_out in ("", *OUTPUTS):
        assert checked(without(left_out, RECORDINGS[recording])) == ()


@pytest.mark.parametrize("recording", RECORDINGS)
@pytest.mark.parametrize("change", [times(RPM, MOTOR, WHEEL), times(1e-3, INPUT, SHAFT)])
def test_a_factor_in_all_speeds_or_all_torques_is_doubted(recording: str, change: Change) -> None:
    """It leaves every ratio and every resonance as it was."""
    (doubt,) = checked(change(RECORDINGS[recording]))
    assert "whether all speeds are in rpm, or all torques in kN m" in doubt


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (swapped, "look swapped"),
        (times(RPM, MOTOR), f"{MOTOR} looks like rpm"),
        (times(-1.0, INPUT), f"{INPUT} looks inverted: both speeds fall"),
        (times(-1.0, MOTOR), f"{MOTOR} looks inverted"),
        (times(-1.0, WHEEL), f"{WHEEL} looks inverted"),
    ],
)
def test_two_speeds_alone_tell_as_much(change: Change, said: str) -> None:
    slow = without(SHAFT, chirp(from_hz=0.05, speed=15.0, seconds=90.0))
    with pytest.raises(BadInputError, match=said):
        checked(change(slow))


def test_a_wheel_speed_in_rpm_beside_motor_speed_alone_is_told_by_the_known_ratio() -> None:
    bad = times(RPM, WHEEL)(without(SHAFT, RECORDINGS["at speed"]))
    assert "in rpm?" in " ".join(checked(bad))
    with pytest.raises(BadInputError, match=f"{WHEEL} looks like rpm"):
        checked(bad, gear_ratio=8.148)


@pytest.mark.parametrize("speed", [0.0, 15.0])
def test_a_wheel_that_a_dyno_holds_is_no_mistake(speed: float) -> None:
    """The motor then swings against the shafts alone: slow torque and slow acceleration are opposite."""
    held = chirp(HELD, speed=speed, noise=0.002)
    for left_out in ("", WHEEL, SHAFT):
        assert checked(without(left_out, held)) == ()
    with pytest.raises(BadInputError, match=f"{MOTOR} looks inverted"):
        checked(times(-1.0, MOTOR)(held))


@pytest.mark.parametrize(
    "use",
    [
        EffectUse("backlash", {"half_gap_rad": 0.005}),
        EffectUse("coulomb_friction", {"torque_nm": 3.0}),
    ],
    ids=lambda use: use.id,
)
def test_effects_are_no_mistake(use: EffectUse) -> None:
    assert checked(chirp(AXLE.with_effects(use), speed=15.0)) == ()


def test_the_command_refuses_with_place_and_remedy_and_writes_nothing(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    pd.DataFrame(swapped(RECORDINGS["at speed"])).to_csv("bad.csv", index=False)
    code = guarded(["identify", "bad.csv", "--out", "out", "--json"])
    said = capsys.readouterr()
    assert (code, said.out) == (2, "")
    assert said.err.startswith("error: bad.csv: motor_speed_rad_s and wheel_speed_rad_s look swapped")
    assert "exchange the two columns" in said.err
    assert not Path("out").exists()


@pytest.mark.slow
def test_a_doubt_is_said_on_standard_error_and_kept(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    pd.DataFrame(times(RPM, MOTOR, WHEEL)(RECORDINGS["at speed"])).to_csv("r.csv", index=False)
    code = guarded(["identify", "r.csv", "--out", "out", "--order", "5", "--json"])
    said = capsys.readouterr()
    assert code == 0
    assert said.err.startswith("warning: the rotor has 0.0021 kg m²")
    notes = json.loads(said.out)["notes"]
    assert any("whether all speeds are in rpm" in note for note in notes)


def test_the_paper_plant_is_taken_without_a_doubt_but_that_it_is_no_chain() -> None:
    """(14)-(16) have a dead time each and belong to no chain."""
    found = identify(experiments_of(paper_plant.recording(paper_plant.chirp(60.0))), order=5)
    assert [doubt.partition(" by ")[0] for doubt in found.doubts] == [
        "the chain misses the measured responses"
    ]


def test_an_inverter_that_gives_less_than_asked_is_doubted_and_not_taken_for_another_unit() -> None:
    asked = paper_plant.chirp(60.0)
    recording = paper_plant.recording(np.clip(asked, -8.0, 8.0))
    doubts = checked({**recording.channels, INPUT: asked})
    assert "that the inverter gives the requested torque" in doubts[-1]
