"""The how-to's device, installed as its reader would, on a pseudo-terminal beside the simulated bench."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from drivers import SerialLine
from hil.core.errors import BadInputError, BenchError
from hil.core.recording import read_recording
from hil.engine import RunOutcome, RunRequest, load_bench, run_plan
from tests.benches_for_tests import SIM, plan

PAGE = Path(__file__).parents[2] / "docs/how-to/own-device.md"
STEPS = """
  - chirp:
      {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 9, duration_s: 1, fade_s: 0.2, amplitude_nm: 10}
"""
PERIOD_S = 0.05


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return found[1]


@pytest.fixture
def oil_unit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    (tmp_path / "oil_unit.py").write_text(block("python"))
    installed = tmp_path / "oil_unit-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: oil_unit\nVersion: 1.0\n")
    points = re.sub(r'project\.entry-points\."(.*?)"', r"\1", block("toml")).replace('"', "")
    (installed / "entry_points.txt").write_text(points)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield importlib.import_module("oil_unit")
    sys.modules.pop("oil_unit", None)


def bench_file(directory: Path, further: str) -> Path:
    text = SIM.text
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{name}"', f'"{SIM.source.parent / name}"')
    path = directory / "bench.toml"
    path.write_text(f"{text}\n{further}")
    return path


def run(directory: Path, hook: Callable[[float], None] = lambda share: None) -> RunOutcome:
    request = RunRequest(plan(STEPS), load_bench(bench_file(directory, block("ini"))), directory / "out")
    request.progress = lambda share, text: hook(share)
    return run_plan(request)


def at(share: float, change: Callable[[], Any]) -> Callable[[float], None]:
    return lambda done: change() if done > share else None


def events(outcome: RunOutcome, kind: str) -> list[str]:
    recording = read_recording(outcome.recording, allow_missing=True)
    return [event.text for event in recording.events if event.kind == kind]


@pytest.mark.slow
def test_its_channel_is_recorded_where_it_was_measured_and_it_becomes_safe(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    units = []
    made = oil_unit.StandIn.__init__

    def remembered(unit: Any, connections: Any) -> None:
        made(unit, connections)
        units.append(unit)

    monkeypatch.setattr(oil_unit.StandIn, "__init__", remembered)
    outcome = run(tmp_path)
    assert (outcome.error, outcome.result.safe_state) == (None, "confirmed")
    recording = read_recording(outcome.recording)
    values = recording["oil_temperature_k"]
    there = np.flatnonzero(~np.isnan(values))
    assert len(there) == pytest.approx(recording.time_s[-1] / PERIOD_S, abs=3)
    np.testing.assert_allclose(np.diff(recording.time_s[there]), PERIOD_S, atol=0.0111)  # seen every 10 ms
    np.testing.assert_allclose(np.diff(values[there]), 0.001, atol=1e-9)  # each once, none twice
    assert [unit.state for unit in units] == ["OFF"]
    assert events(outcome, "safe_state") == ["confirmed by RMCU, dynos and oil"]
    assert outcome.largest["oil_temperature_k"] == pytest.approx(values[there][-1], abs=0.1)


def test_other_channels_are_what_they_are_without_it(oil_unit: ModuleType, tmp_path: Path) -> None:
    del oil_unit
    beside = read_recording(run(tmp_path).recording)
    alone = read_recording(run_plan(RunRequest(plan(STEPS), SIM, tmp_path / "alone")).recording)
    # the oil unit takes its time to come up, and noise goes on meanwhile
    assert list(alone.channels) == [name for name in beside.channels if name != "oil_temperature_k"]
    for name in ("motor_torque_ref_nm", "driving_torque_ref_nm"):
        played = beside[name][np.flatnonzero(beside[name])]
        np.testing.assert_array_equal(played, alone[name][np.flatnonzero(alone[name])])


def test_its_limit_trips_and_the_bench_is_safe(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hot = at(0.4, lambda: monkeypatch.setattr(oil_unit.StandIn, "millikelvin", lambda unit: 370_000))
    outcome = run(tmp_path, hot)
    assert "limit tripped: oil_temperature_k reached 370 K, the limit is 363 K" in str(outcome.error)
    assert (outcome.result.verdict, outcome.result.safe_state) == ("error", "confirmed")


def test_its_silence_ends_the_run(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    silent = at(0.4, lambda: monkeypatch.setattr(oil_unit.StandIn, "say", lambda unit, line: None))
    outcome = run(tmp_path, silent)
    assert isinstance(outcome.error, BenchError)
    assert "device 'oil': reading has stopped coming" in str(outcome.error)
    assert outcome.result.safe_state == "not_confirmed"
    assert events(outcome, "safe_state") == ["oil did not confirm its safe state within 1 s"]


def test_a_unit_that_stays_on_is_not_called_safe_and_the_others_are(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def hear_nothing(unit: Any, now_s: float) -> None:
        unit._alive_s = now_s

    outcome = run(tmp_path, at(0.4, lambda: monkeypatch.setattr(oil_unit.StandIn, "hear", hear_nothing)))
    assert outcome.result.safe_state == "not_confirmed"
    assert events(outcome, "safe_state") == ["oil did not confirm its safe state within 1 s"]


def test_its_trouble_ends_the_run(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    low = at(0.4, lambda: monkeypatch.setattr(oil_unit.OilUnit, "troubles", lambda unit: ["low oil level"]))
    outcome = run(tmp_path, low)
    assert "oil: low oil level" in str(outcome.error)
    assert outcome.result.safe_state == "confirmed"


@pytest.mark.parametrize("where", ["beat", "troubles", "_take", "make_safe", "is_safe"])
def test_a_mistake_in_its_code_leaves_a_traceback_and_everybody_else_safe(
    where: str, oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    right: Any = getattr(oil_unit.OilUnit, where)
    broken: list[bool] = []

    def wrong(unit: Any, *arguments: Any) -> Any:
        if broken:
            raise ZeroDivisionError("in a device")
        return right(unit, *arguments)

    monkeypatch.setattr(oil_unit.OilUnit, where, wrong)
    outcome = run(tmp_path, at(0.4, lambda: broken.append(True)))
    traceback = events(outcome, "traceback")[0]
    assert "in wrong" in traceback
    assert "ZeroDivisionError: in a device" in traceback
    assert isinstance(outcome.error, BenchError)
    (said,) = events(outcome, "safe_state")
    if where in ("beat", "troubles"):
        assert said == "confirmed by RMCU, dynos and oil"
    else:  # and no one but the oil unit is complained of
        expected = "oil did not confirm its safe state within 1 s(: ZeroDivisionError: in a device)?"
        assert re.fullmatch(expected, said)


def test_a_device_that_cannot_be_closed_costs_no_run_its_outcome(
    oil_unit: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def wrong(unit: Any) -> None:
        raise ZeroDivisionError("in a device")

    monkeypatch.setattr(oil_unit.OilUnit, "close", wrong)
    outcome = run(tmp_path)
    assert (outcome.error, outcome.result.safe_state) == (None, "confirmed")


def test_a_port_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"device 'oil' \(.*none\): cannot be opened"):
        SerialLine("oil", str(tmp_path / "none"))


@pytest.mark.parametrize(
    ("further", "said"),
    [
        (
            "[devices.oil]\nkind = 'oil-unti'\nport = 'x'",
            "devices.oil.kind = 'oil-unti': no installed package",
        ),
        ("[devices.oil]\nkind = 'oil-unti'\nport = 'x'", "did you mean 'oil-unit'?"),
        ("[devices.oil]\nport = 'x'", "devices.oil.kind: is missing"),
        ("[devices.oil]\nkind = 'oil-unit'", "devices.oil.port: is missing"),
        ("[devices.oil]\nkind = 'oil-unit'\nport = 3", "devices.oil.port = 3"),
        ("[devices.oil]\nkind = 'oil-unit'\nport = 'x'\npart = 1", "devices.oil.part: unknown key"),
        ("[devices]\noil = 3", "devices.oil = 3"),
        ("[devices.'a/b']\nkind = 'oil-unit'\nport = 'x'", "is a path"),
        ("[limits.channels]\noil_temperature_k = {}", "sets no limit"),
        ("[limits.channels]\noil_temperature_k = {below = 2.0, above = 1.0}", "'below' is not less than"),
        ("[limits.channels]\noil_temperature_k = {above = nan}", "limits.channels.oil_temperature_k.above"),
    ],
)
def test_a_mistake_in_the_bench_file_is_told_with_its_key(
    further: str, said: str, oil_unit: ModuleType, tmp_path: Path
) -> None:
    del oil_unit
    with pytest.raises(BadInputError) as caught:
        load_bench(bench_file(tmp_path, further))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("further", "said"),
    [
        ("[limits.channels]\noil_pressure_pa = {above = 1e5}", "limits.channels.oil_pressure_pa: no device"),
        (block("ini").replace("[limits", "[devices.more]\nkind = 'oil-unit'\nport = 'x'\n[limits"),
         "channel 'oil_temperature_k' is also given by device 'oil'"),
    ],
)  # fmt: skip
def test_channels_that_do_not_go_together_are_refused_before_anything_moves(
    further: str, said: str, oil_unit: ModuleType, tmp_path: Path
) -> None:
    del oil_unit
    with pytest.raises(BadInputError) as caught:
        run_plan(RunRequest(plan(STEPS), load_bench(bench_file(tmp_path, further)), tmp_path / "out"))
    assert said in str(caught.value)
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize(("key", "said"), [("rmcu", "the simulated bench has only 'rmcu-can'"),
                                           ("dyno", "is not a dyno device")])  # fmt: skip
def test_a_device_does_not_stand_in_another_ones_place(
    key: str, said: str, oil_unit: ModuleType, tmp_path: Path
) -> None:
    del oil_unit
    path = bench_file(tmp_path, "")
    path.write_text(re.sub(rf"\[{key}\][^[]*", f"[{key}]\nkind = 'oil-unit'\nport = 'x'\n", path.read_text()))
    with pytest.raises(BadInputError) as caught:
        load_bench(path)
    assert said in str(caught.value)
