"""All that is wrong with a file is reported at once, each mistake with its line and what was meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.controller import controller_from_toml
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import Mistake, MistakesError, all_of, refuse
from hil.core.model import load_model
from hil.engine import load_bench
from test_plans import plan_from_text
from tests.hil.core.model.test_schemas import BENCHES, CONTROLLERS


def changed(path: Path, *changes: tuple[str, str]) -> str:
    text = path.read_text("utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def test_of_a_model(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    wrong = (
        ("shaft_stiffness ", "shaft_stifness "),
        ("8.148", '"8"'),
        ('id = "wheel_order', 'id = "weel_order'),
    )
    path.write_text(changed(BENCHES / "three_inertia.toml", *wrong), "utf-8")
    with pytest.raises(BadInputError) as caught:
        load_model(path)
    head, *told = str(caught.value).splitlines()
    assert head == f"{path}: 3 mistakes"
    assert [line.partition(";")[0] for line in told] == [
        "  line 7: parameters.gear_ratio is '8', not a finite number",
        "  line 8: unknown key 'parameters.shaft_stifness'",
        "  line 16: unknown effect id 'weel_order_disturbance'",
    ]
    assert "did you mean 'shaft_stiffness'?" in told[1]
    assert "did you mean 'wheel_order_disturbance'?" in told[2]


def test_of_several_effects_each_with_its_line(tmp_path: Path) -> None:
    text = (BENCHES / "three_inertia.toml").read_text("utf-8")
    effects = "\n[[effects]]\nid = 'backlash'\n[[effects]]\nid = 'sensor_gain'\nchannel = 'x'\ngain = 'y'\n"
    (tmp_path / "m.toml").write_text(text + effects, "utf-8")
    lines = text.count("\n")
    with pytest.raises(BadInputError) as caught:
        load_model(tmp_path / "m.toml")
    told = str(caught.value)
    assert f"line {lines + 2}: effect 'backlash' needs 'half_gap_rad' (rad)" in told
    assert f"line {lines + 6}: effect 'sensor_gain': a model has no channel 'x'" in told
    assert f"line {lines + 7}: effect 'sensor_gain': 'gain' is 'y'" in told


def test_of_a_controller() -> None:
    path = next(path for path in CONTROLLERS if path.stem.startswith("phase"))
    text = changed(path, ("proportional_gain", "proportional_gian"), ("alpha = 0.25962", "alpha = 3"))
    with pytest.raises(BadInputError) as caught:
        controller_from_toml(text, "c.toml")
    assert str(caught.value).splitlines() == [
        "c.toml: 2 mistakes",
        "  line 15: wsc.proportional_gian: unknown key; did you mean 'proportional_gain'?",
        "  line 20: wsc.lead.alpha = 3: it lies from 0.0019 to 1: (6) gives 0.0019 for 85 degrees of lead, "
        "the most that can be made",
    ]


def test_of_a_bench_device_tables_too(tmp_path: Path) -> None:
    wrong = (("\ndbc", "\ndcb"), ("persistence_s", "persistance_s"), ("[vehicle]", "[vehicles]"))
    (tmp_path / "b.toml").write_text(changed(BENCHES / "sim.toml", *wrong), "utf-8")
    with pytest.raises(BadInputError) as caught:
        load_bench(tmp_path / "b.toml")
    assert str(caught.value).splitlines()[1:-1] == [
        "  line 18: rmcu.dcb: unknown key; did you mean 'dbc'?",
        "  line 22: dyno.eds = 'rcs_dyno.eds': No such file or directory; check [dyno] eds",
        "  line 27: vehicles: unknown key; did you mean 'vehicle'?",
        "  line 39: limits.persistance_s: unknown key; did you mean 'persistence_s'?",
        "  line 46: simulation.model = 'three_inertia.toml': there is no such file",
    ]


def test_of_a_plan_its_steps_within_steps_and_criteria() -> None:
    text = """
name: p
steps:
  - hold_speed: {speed_kmh: 30, duration_s: -2}
  - repeat: {times: 2, steps: [{wiat: {}}, {wait: {duration_s: x}}]}
finally: [{step: {}}]
criteria:
  - {segment: x, metric: peek}
  - {segment: x, metric: peak_shaft_torque}
"""
    with pytest.raises(BadInputError) as caught:
        plan_from_text(text, "p.yaml", Path())
    head, *told = str(caught.value).splitlines()
    assert head == "p.yaml: 11 mistakes"
    places = [line.split("'")[1] for line in told]
    assert places[:4] == [
        "steps[1].hold_speed.speed_kmh",
        "steps[1].hold_speed.duration_s",
        "steps[2].repeat.steps[1].wiat",
        "steps[2].repeat.steps[2].wait.duration_s",
    ]
    assert places[-1] == "criteria[1].metric"  # which segments there would be no one knows


def test_of_several_files() -> None:
    all_of([])
    one = BadInputError("is wrong", where="a")
    with pytest.raises(BadInputError) as caught:
        all_of([one])
    assert caught.value is one
    with pytest.raises(BadInputError, match="2 files cannot be used\na: is wrong\nb: too\n  mend it"):
        all_of([one, BadInputError("too", where="b", fix="mend it")])


def test_of_very_many_as_many_as_somebody_reads() -> None:
    with pytest.raises(MistakesError) as caught:
        refuse(
            "m.toml", (Mistake(f"key_{number}", f"unknown key 'key_{number}'") for number in range(50_000))
        )
    told = str(caught.value).splitlines()
    assert told[0] == "m.toml: 50000 mistakes"
    assert told[1:3] == ["  unknown key 'key_0'", "  unknown key 'key_1'"]
    assert told[-1] == f"  and {50_000 - len(told) + 2} more, when these are corrected"
    assert len(str(caught.value)) < 5000
    assert len(caught.value.found) == 50_000
