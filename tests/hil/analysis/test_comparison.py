"""Runs side by side: criteria, distances, and what differs in what was given."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.comparison import (
    ComparedRun,
    compare,
    difference,
    differences,
    names_by_variables,
    plan_summary,
)
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.result import CriterionResult, RunResult, Segment, VariableValue
from reports.comparison import comparison_html, comparison_pdf, lead, plans_apart, value_text

PLAN = b"name: one\nsteps: [{wait: {duration_s: 1}}]\ncriteria: []\n"


def run(name, scale=1.0, delay_s=0.0, plan=PLAN, controller=b"p = 1", value: float | None = 400.0):
    """A step of 326 N m at 2 s and `delay_s`, with a swing; its peak criterion has `value`."""
    time = np.arange(0, 20_000) / 1000.0
    u = np.maximum(time - 2 - delay_s, 0)
    torque = scale * 326 * (1 - np.exp(-5 * u)) + 20 * scale * np.sin(60 * u) * np.exp(-u)
    channels = {"time_s": time, "shaft_torque_nm": torque, "motor_speed_rad_s": 8.0 * u}
    segment = Segment(id="s", start_s=1.0 + delay_s, step_s=2.0 + delay_s, end_s=18.0, controller="gain")
    criteria = (
        CriterionResult(id="s.peak", value=value, unit="N m", upper=500.0, verdict="pass"),
        CriterionResult(id="s.peak.below.t", value=value, unit="N m", below="t", verdict="pass"),
    )
    result = RunResult(
        verdict="pass",
        plan="one",
        bench="sim",
        real_time_factor=1.0,
        bench_time_s=20.0,
        safe_state="confirmed",
        criteria=criteria,
        segments=(segment,),
    )
    recording = Recording(
        channels, Path(f"{name}.mcap"), attachments={"plan.yaml": plan, "controller/gain.toml": controller}
    )
    return ComparedRun(name, recording, result)


def test_values_stand_beside_each_other_with_their_difference_from_the_first():
    found = compare([run("bench"), run("base", value=300.0), run("augmented", value=396.0)])
    row = found.criteria[0]
    assert row.values == (400.0, 300.0, 396.0)
    assert row.relative == pytest.approx((0.0, -0.25, -0.01))
    assert found.distances == pytest.approx((0.0, 0.25, 0.01))  # a relative criterion does not count twice
    assert value_text(row, 1) == "300.0 (−25.0\u202f%)"
    assert lead(found) == "Mean distance of the criteria from bench: base 25.0\u202f%, augmented 1.0\u202f%."


def test_a_run_that_began_later_is_aligned_at_its_step():
    found = compare([run("one"), run("late", delay_s=0.5)])
    gaps = {row.channel: row.gaps for row in found.responses}
    assert gaps["shaft_torque_nm"] == pytest.approx((0.0, 0.0), abs=1e-6)


def test_the_gap_is_the_rms_of_the_difference_over_the_firsts_spread():
    one, two = run("one"), run("two", scale=1.1)
    found = difference(one, two, "s", "shaft_torque_nm")
    assert found is not None
    time, apart = found
    inside = (one.recording.time_s >= 1.0) & (one.recording.time_s < 18.0)
    first = one.recording["shaft_torque_nm"][inside]
    assert apart == pytest.approx(0.1 * first)
    assert time[0] == pytest.approx(-1.0)
    row = compare([one, two]).responses[0]
    assert row.gaps[1] == pytest.approx(0.1 * np.sqrt(np.mean(first**2)) / np.std(first))


def rippled(name, phase):
    """A step with a wheel order of 30 N m that does not decay, at a phase of its own."""
    one = run(name)
    ripple = 30.0 * np.sin(2 * np.pi * 11.3 * one.recording.time_s + phase)
    channels = dict(one.recording.channels)
    channels["shaft_torque_nm"] = one.recording["shaft_torque_nm"] + ripple
    return ComparedRun(name, dataclasses.replace(one.recording, channels=channels), one.result)


def test_ripple_in_antiphase_is_no_difference():
    same, more = rippled("two", np.pi), run("three", scale=1.3)
    found = compare([rippled("one", 0.0), same, more])
    row = next(row for row in found.responses if row.channel == "shaft_torque_nm")
    assert row.gaps[1] == pytest.approx(row.ripples[1], rel=0.01)
    assert row.gaps[1] > 0.25  # without a word it reads as another controller
    assert "≈" in comparison_html(compare([rippled("one", 0.0), rippled("two", 0.9 * np.pi)]))
    assert row.within_ripple(2) is False


def test_runs_are_named_by_the_variables_in_which_they_differ():
    def result(**values):
        variables = tuple(VariableValue(name=name, value=value, unit="N m") for name, value in values.items())
        return run("one").result.model_copy(update={"variables": variables})

    two = [result(torque=100.0, least=1.0), result(torque=200.0, least=1.0)]
    assert names_by_variables(["a/1", "a/2"], two) == ["torque = 100 N m", "torque = 200 N m"]
    assert names_by_variables(["a/1", "a/2"], [two[0], two[0]]) == ["a/1", "a/2"]
    assert names_by_variables(["a/1", "a/2", "a/3"], [*two, two[0]]) == ["a/1", "a/2", "a/3"]


def test_without_a_value_there_is_no_distance():
    found = compare([run("one", value=None), run("two")])
    assert found.criteria[0].relative == (None, None)
    assert found.distances == (None, None)
    assert "No criterion" in lead(found)


def test_a_segment_that_a_run_lacks_has_no_gap():
    short = run("short")
    short = dataclasses.replace(short, result=short.result.model_copy(update={"segments": ()}))
    assert np.isnan(compare([run("one"), short]).responses[0].gaps[1])


def test_another_title_is_the_same_plan():
    assert plan_summary(run("one"), run("two", plan=PLAN + b"title: again\n")).shown == ()


def test_controllers_that_differ_are_noted():
    found = compare([run("one"), run("two", controller=b"p = 2")])
    assert found.notes == ("Controllers differ between the runs: gain.toml.",)


def test_one_run_is_no_comparison():
    with pytest.raises(BadInputError, match="one run cannot be compared"):
        compare([run("one")])


def test_the_page_shows_every_run_and_stands_on_its_own():
    found = compare([run("bench"), run("base <i>", scale=1.2, value=510.0)])
    page = comparison_html(found)
    assert "base &lt;i&gt;" in page
    assert "base <i>" not in page
    assert page.count("<figure") == 5  # on top the first; two responses, their difference, one spectrum
    assert "Reference run: bench" in page
    assert not re.search(r"(src|href)=.?https?:", page.partition('<script type="application/json"')[0])
    assert comparison_pdf(found).startswith(b"%PDF")


LOADING = b"name: one\nsteps: [{set_controller: {file: %s.toml}}]\ncriteria: []\n"


def loading(name, controllers, loads, **more):
    """A run that loads one of its controllers."""
    one = run(name, plan=LOADING % loads.encode())
    attachments = {f"controller/{key}.toml": value for key, value in controllers.items()}
    recording = dataclasses.replace(
        one.recording, attachments={"plan.yaml": LOADING % loads.encode(), **attachments, **more}
    )
    return ComparedRun(name, recording, one.result)


def test_another_controller_is_no_other_plan_and_what_differs_in_it_is_named():
    old, new = b"[wsc]\ngain = 1.0\npole = 2\n", b"[wsc]\ngain = 1.5\npole = 2\n"
    first, other = loading("a", {"old": old}, "old"), loading("b", {"new": new}, "new")
    assert compare([first, other]).notes == ("Controllers differ between the runs: new.toml, old.toml.",)
    assert "old: wsc.gain" in comparison_html(compare([first, other]))
    told = [(one.kind, one.name, one.first, one.other) for one in differences(first, other)]
    assert told == [("controller", "file", "old", "new"), ("controller", "old: wsc.gain", "1.0", "1.5")]


def test_controllers_that_changed_places_are_noted():
    both = {"gain": b"p = 1", "phase": b"p = 2"}
    assert compare([loading("a", both, "gain"), loading("b", both, "phase")]).notes != ()


def test_values_of_model_and_bench_that_differ_are_named_and_where_a_model_is_from_is_not():
    first = loading("a", {}, "c", **{"model.toml": b"[parameters]\nj = 1\n[meta]\nfrom = 'x'\n"})
    other = loading(
        "b", {}, "c", **{"model.toml": b"[parameters]\nj = 2\nk = 3\n", "bench.toml": b"seed = 2"}
    )
    assert [(one.kind, one.name, one.first, one.other) for one in differences(first, other)] == [
        ("model", "parameters.j", "1", "2"),
        ("model", "parameters.k", "–", "3"),
        ("bench", "seed", "–", "2"),
    ]


ORIGINAL = b"""
name: one
variables:
  swing_nm: {default: 20, unit: N m}
steps:
  - set_controller: {file: gain.toml}
  - hold_speed: {speed_km_h: 0, duration_s: 1}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 180, after_s: 2}
criteria:
  - {segment: s, metric: peak, channel: shaft_torque_nm, upper: 500, unit: N m}
"""


def changed(*pairs, name="copy", plan=ORIGINAL):
    for old, new in pairs:
        assert old in plan
        plan = plan.replace(old, new)
    return run(name, plan=plan)


def told(first, other):
    return [(one.kind, one.name, one.first, one.other, one.unit) for one in differences(first, other)]


def test_what_differs_in_a_copy_of_a_plan_is_named_by_segment_and_criterion():
    first = changed()
    higher = changed(
        (b"to_nm: 180", b"to_nm: 200"), (b"upper: 500", b"upper: 450"), (b"default: 20", b"default: 25")
    )
    assert told(first, higher) == [
        ("plan", "variables.swing_nm.default", "20", "25", "N m"),
        ("plan", "segment s (step): to_nm", "180", "200", "N m"),
        ("plan", "criterion s.peak.shaft_torque_nm: upper", "500", "450", "N m"),
    ]


def test_what_a_copy_does_otherwise_is_said_at_the_head_of_the_comparison():
    pairs = [(b"to_nm: 180", b"to_nm: 200"), (b"after_s: 2", b"after_s: 3"), (b"upper: 500", b"upper: 450")]
    found = compare([changed(name="one"), changed(*pairs, (b"name: one", b"name: copy"))])
    line = (
        "The plan of copy differs: segment s (step): to_nm 200 N m instead of 180 N m; segment s (step): "
        "after_s 3 s instead of 2 s; criterion s.peak.shaft_torque_nm: upper 450 N m instead of 500 N m."
    )
    assert plans_apart(found) == (line,)
    assert line in comparison_html(found)
    assert plans_apart(compare([changed(name="one"), changed()])) == ()
    more = b"  - step: {segment: before, from_nm: 0, to_nm: 20}\n  - step: {segment: s,"
    longer = compare(
        [
            changed(name="one"),
            changed(*pairs, (b"default: 20", b"default: 25"), (b"  - step: {segment: s,", more)),
        ]
    )
    assert plans_apart(longer)[0].endswith("; and 1 more.")
    more_steps = compare([changed(name="one"), changed((b"  - step: {segment: s,", more))])
    assert plans_apart(more_steps) == ("The plan of copy differs: segment before (step) is only in it.",)


def test_a_step_that_was_put_in_is_one_difference_and_moves_no_other():
    more = b"  - step: {segment: before, from_nm: 0, to_nm: 20}\n  - step: {segment: s,"
    assert told(changed(), changed((b"  - step: {segment: s,", more))) == [
        ("plan", "segment before (step)", "–", "segment before, from_nm 0, to_nm 20", "")
    ]


def test_a_segment_of_another_kind_is_not_the_same_segment():
    first, ramp = changed(), changed((b"- step:", b"- ramp:"))
    assert [one[1] for one in told(first, ramp)] == ["segment s (step)", "segment s (ramp)"]
    segments = tuple(one.model_copy(update={"kind": "ramp"}) for one in ramp.result.segments)
    other = dataclasses.replace(ramp, result=ramp.result.model_copy(update={"segments": segments}))
    assert np.isnan(compare([first, other]).responses[0].gaps[1])
    assert compare([first, ramp]).responses[0].gaps[1] == 0.0


def test_of_two_plans_criteria_that_a_run_lacks_have_neither_value_nor_verdict():
    first, other = changed(), changed((b"metric: peak", b"metric: jerk"))
    jerk = CriterionResult(id="s.jerk", value=3.0, unit="m/s³", upper=5.0, verdict="pass")
    other = dataclasses.replace(other, result=other.result.model_copy(update={"criteria": (jerk,)}))
    found = compare([first, other])
    rows = {row.id: (row.values, row.verdicts, row.limit) for row in found.criteria}
    assert rows["s.peak"] == ((400.0, None), ("pass", None), "≤ 500")
    assert rows["s.jerk"] == ((None, 3.0), (None, "pass"), "≤ 5")


def test_recordings_without_a_common_channel_are_refused():
    first, other = changed(), changed()
    channels = {"time_s": other.recording.channels["time_s"], "oil_temperature_c": np.zeros(20_000)}
    other = dataclasses.replace(other, recording=dataclasses.replace(other.recording, channels=channels))
    with pytest.raises(BadInputError, match="has no channel in common with"):
        compare([first, other])
