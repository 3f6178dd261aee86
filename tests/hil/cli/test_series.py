"""Several runs of one plan: a folder for each, and the spread of each criterion."""

from __future__ import annotations

import json
import logging
import re
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from hil.app.feedback import LOGGED
from hil.app.series import _BADNESS, announce_series
from hil.cli.run_inputs import all_choices
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.core.result import CriterionVerdict
from hil.engine.bench.bench_file import with_seed
from reports.series_report import limit_in_words
from test_plans import load_plan
from tests.benches_for_tests import SIM
from tests.hil.cli.test_commands import hil

PLAN = """
name: tip
variables: {torque_nm: {default: 150, unit: N m, upper: 300}}
steps:
  - set_controller: {file: phase_stabilization.toml}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: $torque_nm, before_s: 0.2, after_s: 1}
finally: [ramp_down: {duration_s: 0.2}]
criteria: [{segment: s, metric: peak_shaft_torque, upper: 250, unit: N m}]
"""


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("series") / "tip.yaml"
    path.write_text(PLAN)
    return path


@pytest.mark.slow
def test_every_combination_has_a_folder_and_repeats_have_a_spread(plan, tmp_path):
    out = tmp_path / "out"
    asked = ("run", plan, "--set", "torque_nm=100,280", "--repeat", "2", "--out", out)
    told = json.loads(hil(*asked, "--json", code=1).stdout)  # 280 N m goes beyond the limit
    assert told == json.loads((out / "series.json").read_text())
    assert [run["folder"] for run in told["runs"]] == ["001", "002", "003", "004"]
    assert [run["verdict"] for run in told["runs"]] == ["pass", "pass", "fail", "fail"]
    low, high = (group["criteria"]["s.peak_shaft_torque"] for group in told["spread"])
    assert (low["count"], high["count"], low["unit"]) == (2, 2, "N m")
    assert 0 < low["standard_deviation"] < 2  # of the sensors' noise, which is another one each time
    assert low["lowest"] < low["mean"] < low["highest"] < high["lowest"]
    assert (low["lower"], low["upper"], low["verdict"], high["verdict"]) == (None, 250.0, "pass", "fail")
    page = (out / "series.html").read_text()
    assert "2 of 4 runs passed" in page
    assert "≤ 250" in page
    for run in told["runs"]:
        assert f'<a href="{run["report"]}">{run["folder"]}</a>' in page
        assert (out / run["report"]).is_file()
    recording = read_recording(out / "002/recording.mcap")
    assert "default: 100" in recording.attachments["plan.yaml"].decode()
    assert recording.metadata["run"]["variables"] == "torque_nm = 100 N m"
    assert tomllib.loads(recording.attachments["bench.toml"].decode())["simulation"]["seed"] == 2
    assert json.loads((out / "003/result.json").read_text())["variables"] == [
        {"name": "torque_nm", "value": 280.0, "unit": "N m"}
    ]
    assert "torque_nm = 280 N m" in (out / "003/report.html").read_text()
    assert "holds results already" in hil(*asked, code=2).stderr


def test_nothing_is_run_where_one_of_the_values_may_not_be_chosen(plan, tmp_path):
    out = tmp_path / "out"
    said = hil("run", plan, "--set", "torque_nm=100,301", "--out", out, code=2).stderr
    assert "301 N m is above the largest" in said
    assert not out.exists()


@pytest.mark.parametrize("given", ["torque_nm", "torque_nm=", "torque_nm=1,,2", "torque_nm=nan", "a=1 N"])
def test_what_is_no_number_is_refused(given, plan):
    assert "--set" in hil("check", plan, "--set", given, code=2).stderr


def test_combinations_come_in_the_order_given():
    found = [dict(choice.values) for choice in all_choices(["a=1,2", "b=3,4"], None)]
    assert found == [{"a": 1, "b": 3}, {"a": 1, "b": 4}, {"a": 2, "b": 3}, {"a": 2, "b": 4}]
    assert [dict(choice.values) for choice in all_choices(None, None)] == [{}]


def test_a_bench_of_another_seed_says_so():
    other = with_seed(SIM, 7)
    assert other.simulation.seed == tomllib.loads(other.text)["simulation"]["seed"] == 7
    assert other.model_copy(update={"text": SIM.text, "simulation": SIM.simulation}) == SIM


def test_a_series_says_its_size_and_is_bounded(plan, tmp_path, caplog):
    many = ",".join(str(number) for number in range(2000))
    with pytest.raises(BadInputError, match="the values make 4000 combinations, at most 1000 runs"):
        next(all_choices([f"a={many}", "b=1,2"], None))
    loaded = load_plan(str(plan))
    with pytest.raises(BadInputError, match="3 combinations, 400 times each, are 1200 runs"):
        announce_series([loaded] * 3, 400, tmp_path / "new", LOGGED)
    with caplog.at_level(logging.INFO):
        announce_series([loaded] * 2, 3, tmp_path / "new", LOGGED)
    assert re.search(r"6 runs, \S+ min of bench time, at most \S+ GB on the disk", caplog.text)


def test_every_verdict_has_its_place_among_the_worst():
    assert set(_BADNESS) == set(get_args(CriterionVerdict))


def test_a_limit_that_another_segment_sets_is_named_by_it():
    limits = {"lower": None, "upper": 3.0, "below": ""}
    assert limit_in_words(limits) == "≤ 3"
    assert limit_in_words(limits | {"upper": None, "below": "gain_0kmh"}) == "below gain_0kmh"
    assert limit_in_words(limits | {"lower": 1.0}) == "≥ 1 ≤ 3"
    assert limit_in_words(limits | {"upper": None}) == "-"
