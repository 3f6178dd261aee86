"""`hil list runs --server`: runs of a service from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hil.cli._app import guarded
from tests.hil.service.served import SHORT, served


@pytest.mark.slow
def test_runs_of_a_service_are_chosen_and_sorted_by_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        service.over(service.queue(values={"torque_nm": 100}))
        command = ["--server", service.url, "list", "runs"]
        assert guarded([*command, "--json", "--plan", "short"]) == 0
        found = json.loads(capsys.readouterr().out)
        assert found["total"] == 1
        assert found["runs"][0]["run"]["plan"] == "short"
        assert guarded([*command, "--criterion", "s.peak_shaft_torque", "--sort", "value"]) == 0
        shown = capsys.readouterr().out
        assert "1 of 1 runs" in shown
        assert " N m" in shown
        assert guarded([*command, "--verdict", "error", "--since", "2020-01-01"]) == 0
        assert "0 of 0 runs" in capsys.readouterr().out
        service.ask("PUT", "/api/v1/runs/1/tags/axle-7")
        assert guarded([*command, "--tag", "cold", "--tag", "axle-7"]) == 0
        shown = capsys.readouterr().out
        assert "axle-7" in shown
        assert "1 of 1 runs" in shown
        assert guarded([*command, "--tag", "cold"]) == 0
        assert "0 of 0 runs" in capsys.readouterr().out


def test_runs_of_a_folder_have_no_tags(capsys: pytest.CaptureFixture[str]) -> None:
    assert guarded(["list", "runs", "--tag", "axle-7"]) == 2
    assert "only runs of a service have tags" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["runs", "out"], "DIR does not go with --server"),
        (["runs", "--sort", "margin"], "a service does not sort by 'margin'"),
        (["runs", "--verdict", "fine"], "--verdict"),
        (["runs", "--tag", "two words"], "--tag"),
        (["runs"], "127.0.0.1:9"),
        (["plans"], "--server goes with `hil list runs`"),
    ],
)
def test_wrong_input_is_one_message(
    options: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert guarded(["list", *options, "--server", "http://127.0.0.1:9"]) in (2, 3)
    assert said in capsys.readouterr().err
