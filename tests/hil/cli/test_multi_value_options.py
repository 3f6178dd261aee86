"""Options that take several values."""

import json

import pytest

from hil.cli._app import each_with_its_option, guarded
from hil.core.model import save_model
from hil.core.recording import write_recording
from tests.hil.analysis.diagnosis.one_recording import MODEL, recorded


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("a --holdout b", "a --holdout b"),
        ("a --holdout b c --out o", "a --holdout b --holdout c --out o"),
        ("--holdout b c --out o a", "--holdout b --holdout c --out o a"),
        ("a --holdout b --holdout c d", "a --holdout b --holdout c --holdout d"),
        ("a --holdout=b c", "a --holdout=b c"),
        ("a --holdout b -- c d", "a --holdout b -- c d"),
        ("a --holdout", "a --holdout"),
        ("a b --other c d", "a b --other c d"),
    ],
)
def test_each_value_gets_its_option(given, meant):
    assert list(each_with_its_option(given.split(), ("--holdout",))) == meant.split()


@pytest.mark.slow
def test_several_recordings_are_held_out(tmp_path, capsys):
    save_model(MODEL, tmp_path / "model.toml")
    for seed, name in enumerate("abc"):
        write_recording(recorded(seed=seed), tmp_path / f"{name}.csv")
    a, b, c = (str(tmp_path / f"{name}.csv") for name in "abc")
    options = ["--model", str(tmp_path / "model.toml"), "--out", str(tmp_path / "out"), "--json"]
    assert guarded(["diagnose", a, "--holdout", b, c, *options]) == 0
    both = json.loads(capsys.readouterr().out)
    assert guarded(["diagnose", a, "--holdout", b, "--holdout", c, *options, "--overwrite"]) == 0
    assert json.loads(capsys.readouterr().out)["holdout_gap"] == both["holdout_gap"]
    assert guarded(["diagnose", a, "--holdout", b, *options, "--overwrite"]) == 0
    assert json.loads(capsys.readouterr().out)["holdout_gap"] != both["holdout_gap"]
