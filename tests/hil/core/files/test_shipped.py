"""Shipped models and targets by their names, wherever a file of theirs is taken."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.cli._app import guarded
from hil.core.errors import BadInputError
from hil.core.files.shipped import shipped_file, shipped_names
from hil.core.model import load_model
from hil.engine import load_bench
from hil.engine.bench.bench_file import shipped


def test_every_shipped_model_is_read_by_its_name() -> None:
    assert shipped_names("model") == ("paper_car_axle", "paper_functions", "road_axle", "three_inertia")
    for name in shipped_names("model"):
        assert load_model(Path(name)) == load_model(shipped(f"{name}.toml"))


def test_the_targets_of_the_paper_are_no_model() -> None:
    assert shipped_names("targets file") == ("paper_targets",)
    with pytest.raises(BadInputError, match="there is no model 'paper_targets'"):
        shipped_file("paper_targets", "model")


def test_a_path_stays_as_it_is_and_a_file_comes_before_a_name(tmp_path: Path) -> None:
    assert shipped_file("three_inertia.toml", "model") == Path("three_inertia.toml")
    assert shipped_file("gone/three_inertia", "model") == Path("gone/three_inertia")
    (tmp_path / "three_inertia").touch()
    assert shipped_file("three_inertia", "model", tmp_path) == tmp_path / "three_inertia"


@pytest.mark.parametrize("name", ["tree_inertia", "x" * 5000, "a\0b", "sim"])
def test_an_unknown_name_is_answered_with_the_known_ones(name: str) -> None:
    with pytest.raises(BadInputError, match="there is no model") as caught:
        shipped_file(name, "model")
    assert "known: paper_car_axle, paper_functions, road_axle, three_inertia" in caught.value.fix


def test_a_bench_file_names_a_shipped_model(tmp_path: Path) -> None:
    text = shipped("sim.toml").read_text("utf-8")
    text = text.replace('"rmcu.dbc"', f'"{shipped("rmcu.dbc")}"')
    text = text.replace('"rcs_dyno.eds"', f'"{shipped("rcs_dyno.eds")}"')
    (tmp_path / "own.toml").write_text(text.replace('"three_inertia.toml"', '"three_inertia"'))
    assert load_bench(tmp_path / "own.toml").simulation.model == shipped("three_inertia.toml")
    (tmp_path / "own.toml").write_text(text.replace('"three_inertia.toml"', '"tree_inertia"'))
    with pytest.raises(BadInputError, match="simulation.model = 'tree_inertia': there is no such file"):
        load_bench(tmp_path / "own.toml")


@pytest.mark.parametrize(
    "command",
    [
        ("run", "acceptance", "--model", "NAME"),
        ("design", "--model", "NAME"),
        ("tune", "acceptance", "--model", "NAME"),
        ("autotune", "--model", "NAME"),
        ("diagnose", "--model", "NAME", "x.csv"),
        ("explain", "--model", "NAME", "paper_targets"),
        ("simulate", "--model", "NAME", "--input", "x.csv", "--out", "y.csv"),
        ("export", "NAME", "--out", "x.fmu"),
    ],
    ids=lambda words: words[0],
)
def test_every_command_with_a_model_knows_the_names(command, capsys) -> None:
    words = [word.replace("NAME", "tree_inertia") for word in command]
    assert guarded(words) == 2
    assert "did you mean 'three_inertia'?" in capsys.readouterr().err


def test_a_model_by_name_is_a_file_among_the_inputs(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert guarded(["export", "three_inertia", "--out", "unit.fmu"]) == 0
    assert (tmp_path / "unit.fmu").is_file()
