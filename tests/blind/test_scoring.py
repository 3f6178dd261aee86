"""The scoring, with answers that are known."""

from __future__ import annotations

import json

import pytest

from hil.core.effects import EFFECTS
from hil.core.model import load_model
from hil.core.recording import read_recording
from tests.blind.casefiles import Answer, write_case
from tests.blind.cases import draw_case, share_of
from tests.blind.diagnosing import Reply, says_nothing
from tests.blind.families import FAMILIES
from tests.blind.later_families import LATER_FAMILIES
from tests.blind.outsiders import LATER_OUTSIDERS, OUTSIDERS
from tests.blind.run import main
from tests.blind.run_case import run_case
from tests.blind.scoring import KNOWN, errors_of, score
from tests.blind.specs import GROUPS, SIZES, Spec, full_set, subset
from tests.blind.spread import Asked, spread

NOISE = {"motor_speed_rad_s": 0.01, "wheel_speed_rad_s": 0.02, "shaft_torque_nm": 0.02}


def _reply(verdict, *effects, **more):
    entries = [
        {"id": id, "parameters": parameters, "confidence": confidence}
        for id, parameters, confidence in effects
    ]
    return Reply({"verdict": verdict, "effects": entries, **more}, "", 1.0)


def _answer(*effects):
    return Answer(effects, 1.0, NOISE, NOISE)


BACKLASH = ("backlash", {"half_gap_rad": 0.01})
GAIN = ("sensor_gain", {"channel": "shaft_torque_nm", "gain": 1.1})
LATE = ("parameter_mismatch", {"parameter": "torque_delay", "value": 0.009})


@pytest.mark.parametrize(
    ("group", "hidden", "reply", "right"),
    [
        ("single", [BACKLASH], _reply("named", (*BACKLASH, 0.9)), True),
        ("single", [BACKLASH], _reply("named", (*BACKLASH, 0.9), (*GAIN, 0.5)), False),
        ("single", [BACKLASH], _reply("unknown"), False),
        (
            "single",
            [GAIN],
            _reply("named", ("sensor_gain", {"channel": "motor_speed_rad_s", "gain": 1.1}, 0.9)),
            False,
        ),
        ("single", [("dead_time", {"extra_delay_s": 0.004})], _reply("named", (*LATE, 0.9)), True),
        ("mismatch", [LATE], _reply("named", (*LATE, 0.9)), True),
        ("pair", [BACKLASH, GAIN], _reply("named", (*GAIN, 0.9), (*BACKLASH, 0.9)), True),
        ("pair", [BACKLASH, GAIN], _reply("named", (*GAIN, 0.9)), False),
        ("none", [], _reply("none"), True),
        ("none", [], _reply("named", (*GAIN, 0.2)), False),
        ("outside", [("outside:torque_fade", {})], _reply("unknown"), True),
        ("outside", [("outside:torque_fade", {})], _reply("named", ("torque_fading", {}, 0.9)), True),
        ("outside", [("outside:torque_fade", {})], _reply("named", (*BACKLASH, 0.3)), False),
        ("single", [BACKLASH], Reply({}, "exit code 3: broken", 1.0), False),
    ],
)
def test_what_is_right(group, hidden, reply, right):
    result = score(Spec(group, "any", "clear", 0), "two_inertia", _answer(*hidden), reply)
    assert result.right is right


def test_a_class_stands_for_each_of_its_names():
    reply = _reply("named", ("actuator_lag", {"time_constant_s": 0.01}, 0.9))
    reply.diagnosis["effects"][0]["class"] = "actuator_lag or sensor_gain(shaft_torque_nm)"
    spec = Spec("single", "sensor_gain", "clear", 0)
    found = score(spec, "two_inertia", _answer(GAIN), reply)
    assert (found.right, found.named, found.parameter_errors) == (True, ["sensor_gain(shaft_torque_nm)"], {})
    assert not score(spec, "two_inertia", _answer(BACKLASH), reply).right


def test_gaps_count_in_units_of_the_true_noise():
    gap = {name: {"before": 0.2, "after": 1.1 * ratio, "noise_floor": 1.0} for name, ratio in NOISE.items()}
    reply = _reply("named", (*BACKLASH, 0.99), holdout_gap=gap)
    result = score(Spec("single", "backlash", "clear", 0), "two_inertia", _answer(BACKLASH), reply)
    assert result.worst_gap == pytest.approx(1.1)
    assert result.mean_gap == pytest.approx(1.1)
    assert result.names_right == [(0.99, True)]


def test_errors_of_parameters():
    assert errors_of("sensor_gain", {"gain": 1.1}, {"gain": 1.09})["gain"] == pytest.approx(0.1)
    assert errors_of("backlash", {"half_gap_rad": 0.02}, {"half_gap_rad": 0.019}) == pytest.approx(
        {"half_gap_rad": 0.05}
    )
    assert errors_of("motor_order_ripple", {"phase_rad": 3.1}, {"phase_rad": -3.1})[
        "phase_rad"
    ] == pytest.approx(0.0832, abs=1e-3)
    loop = errors_of(
        "shaft_hysteresis",
        {"stiffness_nm_rad": 100.0, "slip_rad": 0.02},
        {"stiffness_nm_rad": 200.0, "slip_rad": 0.01},
    )
    assert loop == pytest.approx({"slip_torque_nm": 0.0})


def test_flanks_are_compared_where_they_are_told_in_the_same_way():
    truth = {"half_gap_rad": 0.01, "restitution": 0.8}
    told = {"half_gap_rad": 0.011, "contact_damping_nms_rad": 20.0}
    assert errors_of("backlash", truth, told) == pytest.approx({"half_gap_rad": 0.1})
    assert errors_of("backlash", truth, truth | {"restitution": 0.72})["restitution"] == pytest.approx(0.1)


def test_a_wrong_name_with_high_confidence_is_not_honest():
    spec = Spec("one_recording", "backlash", "clear", 0)
    assert not score(spec, "two_inertia", _answer(BACKLASH), _reply("named", (*GAIN, 0.95))).honest
    assert score(spec, "two_inertia", _answer(BACKLASH), _reply("named", (*GAIN, 0.6))).honest


def test_every_registered_effect_can_be_hidden_and_none_of_the_outsiders_is_registered():
    contract = {*FAMILIES, *(id.split(":")[0] for id in LATER_FAMILIES), "parameter_mismatch"}
    assert contract <= set(EFFECTS)
    assert set(KNOWN) == contract
    assert not {*OUTSIDERS, *LATER_OUTSIDERS} & set(EFFECTS)


def test_a_subset_has_every_group_and_is_the_same_again():
    few = subset(full_set(), 24, 3)
    assert {s.group for s in few} == set(GROUPS)
    assert few == subset(full_set(), 24, 3)
    assert len({s.key for s in full_set()}) == len(full_set())
    assert len(subset(full_set(), 700, 3)) == pytest.approx(700, abs=5)


def test_a_case_is_the_same_again_and_its_files_hold_no_answer(tmp_path):
    spec = Spec("single", "torque_saturation", "clear", 0)
    texts = []
    for name in ("first", "again"):
        case = draw_case(5, spec, 0.1)
        (tmp_path / name).mkdir()
        files, answer = write_case(case, tmp_path / name)
        texts.append({p.name: p.read_text() for p in (tmp_path / name).rglob("*.*")})
        model = load_model(files.model)
        assert not model.effects
        assert not model.meta
        recording = read_recording(files.recordings[0])
        assert "shaft_torque_nm" in recording
        assert answer.effects[0][0] == "torque_saturation"
        EFFECTS["torque_saturation"].check(answer.effects[0][1], "answer")
    assert texts[0] == texts[1]


@pytest.mark.slow
@pytest.mark.parametrize("subject", [*LATER_FAMILIES])
@pytest.mark.parametrize("size", ["clear", "middle", "edge"])
def test_effects_that_joined_later_are_drawn_at_the_size_that_is_asked_for(subject, size):
    case = draw_case(1, Spec("single", subject, size, 0), 0.5)
    assert [h.id for h in case.hidden] == [subject.split(":")[0]]
    EFFECTS[case.hidden[0].id].check(case.hidden[0].values, "answer")
    assert 1 / 1.5 < case.share / share_of(SIZES[size]) < 1.5


@pytest.mark.hunt
def test_a_pair_has_the_effect_that_joined_later_and_another():
    for subject in LATER_FAMILIES:
        case = draw_case(1, Spec("pair", subject, "clear", 1), 0.3)
        assert case.hidden[0].id == subject.split(":")[0]
        assert len({h.id for h in case.hidden}) == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spec", "share", "laws"),
    [
        (Spec("pair", "any", "middle", 0), 1.4983368, [{"limit_nm": 43.886446}, {"cubic": 3193.3052}]),
        (
            Spec("outside", "outside:shaft_asymmetry", "clear", 0),
            2.5523546,
            [{"shaft_asymmetry": 0.06899049}],
        ),
    ],
)
def test_what_joins_the_set_leaves_the_cases_that_were_there(spec, share, laws):
    case = draw_case(11, spec, 0.1)
    assert case.share == pytest.approx(share, rel=1e-6)
    assert [h.laws for h in case.hidden] == [pytest.approx(one, rel=1e-6) for one in laws]


@pytest.mark.hunt
def test_a_run_with_a_stand_in_writes_both_files(tmp_path):
    spec = Spec("none", "none", "none", 0)
    result = run_case(2, spec, says_nothing, tmp_path / "kept", 0.1)
    assert result.right
    (model,) = (tmp_path / "kept").rglob("model.toml")
    drawn_at = model.stat().st_mtime_ns
    assert run_case(2, spec, says_nothing, tmp_path / "kept", 0.1) == result  # drawn once, asked again
    assert model.stat().st_mtime_ns == drawn_at
    out = tmp_path / "results.md"
    assert (
        main(
            [
                "--stand-in",
                "--group",
                "none",
                "--cases",
                "1",
                "--length",
                "0.1",
                "--out",
                str(out),
                "--jobs",
                "0",
                "--work",
                str(tmp_path / "work"),
            ]
        )
        == 0
    )
    assert "| none | 1 | 100 |" in out.read_text()
    assert json.loads(out.with_suffix(".json").read_text())["cases"][0]["verdict"] == "none"


def test_a_case_is_done_once_and_done_again_if_anything_has_changed(tmp_path):
    specs = tuple(Spec("none", "none", "none", turn) for turn in range(2))
    shown: list[tuple[int, int]] = []

    def made(specs, seed=1):
        asked = Asked(seed, specs, says_nothing, "nobody", length=0.1)
        shown.clear()
        found = spread(asked, tmp_path, 0, "", lambda score, number: shown.append((score.turn, number)))
        return found, list(shown)

    (first,), told = made(specs[:1])
    assert told == [(0, 1)]
    (again, other), told = made(specs)
    assert (again, other.turn, told) == (first, 1, [(1, 2)])
    assert made(specs)[1] == []
    (tmp_path / "none-none-none-0.json").write_text("{")
    assert made(specs)[1] == [(0, 2)]
    assert len(made(specs, seed=2)[1]) == 2


@pytest.mark.slow
def test_cases_on_workers_are_those_of_one_process(tmp_path):
    specs = tuple(Spec("none", "none", "none", turn) for turn in range(3))
    asked = Asked(1, specs, says_nothing, "nobody", length=0.1)
    here = spread(asked, tmp_path / "here", 0, "", lambda score, number: None)
    there = spread(asked, tmp_path / "there", 2, "", lambda score, number: None)
    assert here == there


def test_a_case_that_ends_its_process_has_failed():
    asked = Asked(1, (Spec("none", "none", "none", 0),), says_nothing, "nobody")
    row = asked.failed(0, "the process died")
    assert row["simulation"] == 0
    assert (row["score"]["failure"], row["score"]["right"]) == ("the process died", False)
