"""The groups that joined the set: what their cases hide, and how answers to them are judged."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hil.core.channels import INPUT, OUTPUTS
from hil.core.effects import EFFECTS
from hil.core.recording import read_recording
from tests.blind.casefiles import LOAD, Answer, write_case
from tests.blind.diagnosing import Reply
from tests.blind.draws import draw
from tests.blind.fairness import holds, judged_gaps, standard_errors_off
from tests.blind.figures import figure_rows
from tests.blind.later_groups import LATER_GROUPS, later_specs
from tests.blind.plant import COARSE, Truth, true_outputs
from tests.blind.reference.controller import MEMORY, ON_MOTOR, control, motor_speed_torque
from tests.blind.scoring import score
from tests.blind.sensors import Sensor
from tests.blind.specs import Spec, full_set

NOISE = dict.fromkeys(OUTPUTS, 0.01)
BACKLASH = ("backlash", {"half_gap_rad": 0.01})
FRICTION = ("coulomb_friction", {"torque_nm": 1.0})
MASS = ("parameter_mismatch", {"parameter": "motor_inertia", "value": 1.0})
LAG = ("actuator_lag", {"time_constant_s": 0.01})
SHORT = 0.05


def _answer(*effects):
    return Answer(effects, 1.0, NOISE, NOISE)


def _reply(verdict, *named, **more):
    effects = [{"id": id, "parameters": values, "confidence": sure} for id, values, sure in named]
    return Reply({"verdict": verdict, "effects": effects, **more}, "", 1.0)


def _rival(id, confidence, test="A coast-down."):
    return {"id": id, "parameters": {}, "confidence": confidence, "separating_test": test}


def _gaps(before, after):
    return {name: {"before": 0.01 * before, "after": 0.01 * after, "noise_floor": 0.5} for name in OUTPUTS}


def test_the_set_grew_by_more_than_150_cases():
    grown = [s for s in full_set() if s.group in LATER_GROUPS]
    assert len(grown) > 150
    assert len({s.key for s in full_set()}) == len(full_set())
    assert len(later_specs()) == len(grown)


@pytest.mark.slow
def test_a_far_base_is_wrong_in_every_parameter_but_the_gear_ratio():
    case = draw(3, Spec("far", "none", "none", 0), SHORT)
    off = {n: case.model.parameters[n] / case.truth.parameters[n] - 1.0 for n in case.model.parameters}
    assert abs(off.pop("gear_ratio")) < 0.016
    assert all(0.19 < abs(one) < 0.81 for one in off.values())
    assert not case.hidden


@pytest.mark.slow
@pytest.mark.parametrize("many", [1, 2])
def test_few_channels_are_written_and_the_sensor_in_question_is_among_them(many, tmp_path):
    how = {1: "one", 2: "two"}[many]
    case = draw(3, Spec("few_channels", f"sensor_offset@{how}", "clear", 0), SHORT)
    assert len(case.channels) == many
    assert case.hidden[0].sensors[0].channel in case.channels
    files, _ = write_case(case, tmp_path)
    recording = read_recording(files.recordings[0])
    assert {name for name in OUTPUTS if name in recording} == {*case.channels}


@pytest.mark.slow
@pytest.mark.parametrize("loop", ["proportional", "pi", "paper", "wheel"])
def test_noise_comes_back_through_the_controller_into_the_torque(loop):
    case = draw(4, Spec("closed_loop", f"none@{loop}", "none", 0), SHORT)
    experiment = next(e for e in case.experiments if e.name == "multisine")
    noise = np.random.default_rng(1).standard_normal((len(experiment.torque_nm), len(OUTPUTS)))
    quiet, _ = true_outputs(case.truth, experiment, substeps=COARSE)
    loud, outputs = true_outputs(case.truth, experiment, noise=0.1 * noise, substeps=COARSE)
    assert np.all(np.isfinite(outputs))
    assert np.std(loud - quiet) > 0.0
    assert np.std(quiet - experiment.torque_nm) > 0.0


def test_the_papers_lead_passes_high_frequency_as_it_is_and_a_quarter_of_the_low():
    c = control(2.0, form=ON_MOTOR, lead_s=0.0078, lead_ratio=0.26, largest_nm=1e3)
    state = np.zeros(MEMORY)
    first = motor_speed_torque(c, state, 0.0, 1.0, 0.0, 1e-4)
    for _ in range(2000):
        last = motor_speed_torque(c, state, 0.0, 1.0, 0.0, 1e-4)
    assert first == pytest.approx(2.0, rel=0.03)
    assert last == pytest.approx(2.0 * 0.26, rel=1e-3)


@pytest.mark.slow
def test_a_braking_dyno_slows_the_axle_by_its_torque():
    parameters = {"motor_inertia": 0.02, "gear_ratio": 8.0, "vehicle_inertia": 300.0}
    base = draw(1, Spec("load_side", "none", "none", 0), SHORT).experiments[0]
    load = np.full(1000, 100.0)
    pushed = dataclasses.replace(
        base, torque_nm=np.zeros(1000), load_nm=load, wheel_speed_rad_s=5.0, closed_loop=False
    )
    rigid = Truth("rigid", parameters | {"viscous_drag": 0.0, "torque_delay": 0.0})
    speed = true_outputs(rigid, pushed)[1][:, 1]
    inertia = 300.0 + 0.02 * 8.0**2
    assert speed[-1] - speed[0] == pytest.approx(-100.0 / inertia * 0.999, rel=1e-6)
    shafts = {"shaft_stiffness": 6000.0, "shaft_damping": 20.0}
    two = Truth("two_inertia", parameters | shafts | {"torque_delay": 0.0})
    outputs = true_outputs(two, pushed)[1]
    momentum = 300.0 * outputs[:, 1] + 0.02 * 8.0 * outputs[:, 0]
    assert momentum[-1] - momentum[0] == pytest.approx(-100.0 * 0.999, rel=1e-4)


@pytest.mark.slow
def test_the_load_is_written_beside_the_torque(tmp_path):
    case = draw(1, Spec("load_side", "none", "none", 2), SHORT)
    files, _ = write_case(case, tmp_path)
    recording = read_recording(files.recordings[0])
    assert np.std(recording[LOAD]) > 5.0 * np.std(recording[INPUT])


def test_a_drift_begins_at_zero():
    sensor = Sensor("motor_speed_rad_s", drift=0.5, drift_period_s=1.0, drift_phase_rad=0.3)
    shown = sensor.read(np.zeros(1000), 1e-3)
    assert shown[0] == 0.0
    assert np.ptp(shown) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.slow
def test_a_drift_counts_as_noise(tmp_path):
    case = draw(1, Spec("drift", "none", "large", 1), 0.3)
    _, answer = write_case(case, tmp_path)
    drifting = case.truth.sensors[0].channel
    plain = dataclasses.replace(case, truth=dataclasses.replace(case.truth, sensors=()))
    (tmp_path / "plain").mkdir()
    _, without = write_case(plain, tmp_path / "plain")
    assert answer.noise[drifting] > 2.0 * without.noise[drifting]


@pytest.mark.slow
@pytest.mark.parametrize("spec", [s for s in full_set() if s.group == "other_laws"], ids=lambda s: s.key)
def test_others_laws_are_drawn_at_the_size_that_is_asked_for(spec):
    case = draw(1, spec, 0.2)
    EFFECTS[case.hidden[0].id].check(case.hidden[0].values, "answer")
    assert case.share == pytest.approx({"large": 9.95, "clear": 2.83}[spec.size], rel=0.2)


@pytest.mark.slow
def test_too_small_an_effect_hardly_widens_the_gap():
    case = draw(1, Spec("too_small", "backlash", "tiny", 0), 0.2)
    assert case.share < 0.08


@pytest.mark.slow
def test_a_tiny_gain_is_not_a_large_one_that_a_gear_ratio_would_explain():
    case = draw(1, Spec("too_small", "sensor_gain", "tiny", 0), 0.2)
    assert case.truth.kind == "rigid"
    assert abs(case.hidden[0].sensors[0].gain - 1.0) < 0.01


@pytest.mark.parametrize(
    ("group", "subject", "hidden", "reply", "right"),
    [
        ("far", "backlash", [BACKLASH], _reply("named", (*BACKLASH, 0.9)), True),
        (
            "far",
            "none",
            [],
            _reply("none", start={"parameters": {"motor_inertia": {"from": 1, "to": 2}}}),
            True,
        ),
        ("far", "none", [], _reply("named", (*MASS, 0.9)), False),
        ("closed_loop", "none@pi", [], _reply("none"), True),
        ("closed_loop", "none@pi", [], _reply("unknown"), False),
        ("too_small", "backlash", [BACKLASH], _reply("none"), True),
        ("too_small", "backlash", [BACKLASH], _reply("named", (*BACKLASH, 0.9)), False),
        ("drift", "none", [], _reply("unknown"), True),
        ("drift", "none", [], _reply("none"), True),
        ("drift", "none", [], _reply("named", (*FRICTION, 0.3)), False),
        (
            "few_channels",
            "backlash@one",
            [BACKLASH],
            _reply("named", (*FRICTION, 0.6), alternatives=[_rival("backlash", 0.4)]),
            True,
        ),
        (
            "few_channels",
            "backlash@one",
            [BACKLASH],
            _reply("named", (*FRICTION, 0.95), alternatives=[_rival("backlash", 0.4)]),
            False,
        ),
        (
            "few_channels",
            "backlash@one",
            [BACKLASH],
            _reply("unknown", alternatives=[_rival("backlash", 0.5), _rival("coulomb_friction", 0.4)]),
            True,
        ),
        (
            "few_channels",
            "backlash@one",
            [BACKLASH],
            _reply("unknown", alternatives=[_rival("backlash", 0.5, ""), _rival("mount_mode", 0.4, "")]),
            False,
        ),
        (
            "few_channels",
            "backlash@one",
            [BACKLASH],
            _reply("unknown", alternatives=[_rival("backlash", 0.5)]),
            False,
        ),
    ],
)
def test_what_is_right(group, subject, hidden, reply, right):
    assert score(Spec(group, subject, "clear", 0), "two_inertia", _answer(*hidden), reply).right is right


def test_a_name_must_shrink_every_gap_by_half_and_none_may_leave_twice_the_noise():
    assert judged_gaps(_answer(), {"verdict": "named", "gap": _gaps(10.0, 6.0)}) == ([*OUTPUTS], [])
    assert judged_gaps(_answer(), {"verdict": "named", "gap": _gaps(10.0, 4.0)}) == ([], [])
    assert judged_gaps(_answer(), {"verdict": "named", "gap": _gaps(1.05, 1.04)}) == ([], [])
    assert judged_gaps(_answer(), {"verdict": "none", "gap": _gaps(2.1, 2.1)}) == ([], [*OUTPUTS])
    assert judged_gaps(_answer(), {"verdict": "none", "gap": _gaps(1.9, 1.9)}) == ([], [])
    assert judged_gaps(_answer(), {"verdict": "unknown", "gap": _gaps(9.0, 9.0)}) == ([], [])


def test_intervals_count_where_plant_and_registry_write_the_same_numbers():
    def held(effect, value, error):
        id, ((name, _),) = effect[0], effect[1].items()
        entry = {"id": id, "parameters": {name: value}, "standard_error": {name: error}}
        off = standard_errors_off(_answer(effect), [entry], [id])
        return [holds(one) for one in off.values()]

    assert held(LAG, 0.0118, 1e-3) == [True]
    assert held(LAG, 0.0122, 1e-3) == [False]
    assert held(FRICTION, 1.0, 0.1) == []


def test_every_figure_has_a_row_with_its_line_and_target():
    reply = _reply("named", (*BACKLASH, 0.9), gap=_gaps(10.0, 1.0), holdout_gap=_gaps(10.0, 1.0))
    scores = [
        score(Spec("far", "backlash", "clear", 0), "two_inertia", _answer(BACKLASH), reply),
        score(Spec("far", "none", "none", 0), "two_inertia", _answer(), _reply("none")),
        score(
            Spec("other_laws", "backlash:kelvin_voigt", "clear", 0), "two_inertia", _answer(BACKLASH), reply
        ),
        score(Spec("few_channels", "backlash@one", "clear", 0), "two_inertia", _answer(BACKLASH), reply),
        score(Spec("few_channels", "actuator_lag@two", "clear", 0), "two_inertia", _answer(LAG), reply),
        score(Spec("closed_loop", "backlash@pi", "clear", 0), "two_inertia", _answer(BACKLASH), reply),
    ]
    rows = {row[0]: row[1:] for row in figure_rows(scores)}
    assert rows["far base, right name alone"] == [1, "100 %", "85 %", "95 %"]
    assert rows["far base, nothing hidden: none"] == [1, "100 %", "100 %", "100 %"]
    assert rows["two channels: right name, or honest rivals"][1] == "0 %"
    assert rows["closed loop, right"] == [1, "100 %", "95 %", "99 %"]
    assert rows["other laws, held-out gap / noise, median / 95th"] == [1, "1 / 1", "1.2 / 3", "1.05 / 1.5"]
    assert rows["`named` while a channel's gap shrank by less than half"] == [5, 0, 0, 0]
    assert rows["processor time per case, median / 95th, s"][1:] == ["1 / 1", "15 / 60", "8 / 25"]
