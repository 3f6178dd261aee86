"""Which bench a command takes that no one has named one to: the own bench.toml, else the simulated one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hil.cli._app import guarded
from hil.engine.bench.bench_file import shipped

PLAN = "name: p\nsteps:\n  - wait: {duration_s: 0.1}\n"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plan.yaml").write_text(PLAN)
    return tmp_path


def write_bench(folder: Path, name: str, source: str = "sim.toml") -> None:
    text = shipped(source).read_text("utf-8")
    for file in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml"):
        text = text.replace(f'"{file}"', f'"{shipped(file)}"')
    text = text.replace('name = "sim"', f'name = "{name}"').replace('channel = "sim/', f'channel = "{name}/')
    folder.mkdir(exist_ok=True)
    (folder / "bench.toml").write_text(text)


def checked_on(capsys: pytest.CaptureFixture[str], plan: str = "plan.yaml") -> tuple[str, str]:
    """The bench, and what was stated of it."""
    assert guarded(["check", plan, "--json"]) == 0
    captured = capsys.readouterr()
    return json.loads(captured.out)["bench"], captured.err


def test_without_a_bench_file_it_is_the_simulated_one_and_nothing_is_said(here, capsys) -> None:
    assert checked_on(capsys) == ("sim", "")


def test_the_bench_file_of_the_current_folder_is_taken_and_named(here, capsys) -> None:
    write_bench(here, "mine")
    (here / "plans").mkdir()
    (here / "plans/plan.yaml").write_text(PLAN)
    for plan in ("plan.yaml", "plans/plan.yaml"):
        bench, said = checked_on(capsys, plan)
        assert (bench, said) == ("mine", "note: the bench is bench.toml; --bench names another\n")


def test_the_one_beside_the_plan_comes_first(here, capsys) -> None:
    write_bench(here, "mine")
    write_bench(here / "plans", "theirs")
    (here / "plans/plan.yaml").write_text(PLAN)
    bench, said = checked_on(capsys, "plans/plan.yaml")
    assert bench == "theirs"
    assert "plans/bench.toml" in said


def test_a_run_takes_it_too(here, capsys) -> None:
    write_bench(here, "mine")
    assert guarded(["run", "plan.yaml", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["bench"] == "mine"
    assert guarded(["run", "plan.yaml", "--bench", "sim", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["bench"] == "sim"


def test_hardware_is_driven_only_if_it_is_named_but_checked_as_it_lies_there(here, capsys) -> None:
    write_bench(here, "rear_axle", "rear_axle_socketcan.toml")
    assert guarded(["run", "plan.yaml"]) == 2
    said = capsys.readouterr().err
    assert "bench.toml: describes hardware, which is driven only if it is named" in said
    assert "--bench sim is the simulated bench" in said
    assert not (here / "out").exists()
    assert checked_on(capsys)[0] == "rear_axle"
