"""A folder of one's own is ready: check, run and pytest work in it as it stands."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hil.cli.test_commands import hil


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("own") / "mine"
    hil("init", place)
    return place


def test_check_foresees_that_every_criterion_is_kept(folder):
    told = hil("check", "plan.yaml", "--bench", "bench.toml", cwd=folder).stdout
    assert "fits the bench" in told
    assert "fail" not in told


@pytest.mark.slow
def test_run_and_pytest_pass(folder, tmp_path):
    hil("run", "plan.yaml", "--bench", "bench.toml", "--out", tmp_path / "out", cwd=folder)
    tried = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert "4 passed, 2 skipped" in tried.stdout, tried.stdout


@pytest.mark.slow
def test_samples_hold_the_backlash_that_a_diagnosis_finds(tmp_path):
    hil("init", tmp_path / "mine", "--samples")
    files = "chirp_high.csv", "chirp_low.csv", "steps.csv", "--holdout", "multisine.csv"
    done = hil("diagnose", "--model", "axle.toml", *files, "--json", cwd=tmp_path / "mine")
    found = json.loads(done.stdout)
    assert found["verdict"] == "named"
    assert [effect["id"] for effect in found["effects"]] == ["backlash"]
    assert found["effects"][0]["parameters"]["half_gap_rad"] == pytest.approx(0.01, rel=0.02)


def test_what_is_in_use_stays_as_it_is(folder, tmp_path):
    before = (folder / "plan.yaml").read_bytes()
    assert "is not empty" in hil("init", folder, code=2).stderr
    assert (folder / "plan.yaml").read_bytes() == before
    (tmp_path / "file").write_text("mine")
    assert "not a directory" in hil("init", tmp_path / "file", code=2).stderr
    assert (tmp_path / "file").read_text() == "mine"


def test_an_empty_folder_is_filled(tmp_path):
    hil("init", tmp_path)
    assert {"plan.yaml", "bench.toml", "model.toml", "README.md"} <= {
        path.name for path in tmp_path.iterdir()
    }
