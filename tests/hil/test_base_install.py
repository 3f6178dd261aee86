"""A base install runs plans and writes reports; what it leaves out is told with the extra that brings it."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from hil.core.errors.extras import MODULES, PURPOSES, not_installed

ROOT = Path(__file__).parents[2]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
#: Distributions whose module has another name.
NAMES = {"skrf": "scikit-rf", "dask": "distributed"}
#: Runs the command line as if the libraries of extras were not there.
WITHOUT = f"""
import importlib.abc, sys

class Without(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in {sorted(MODULES)!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Without())
from hil.cli import main
sys.exit(main())
"""
PLAN = """
name: short
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.3}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.2, after_s: 2}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
"""


def hil(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", WITHOUT, *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


def test_the_table_is_that_of_the_package() -> None:
    for module, extra in MODULES.items():
        assert any(one.startswith(NAMES.get(module, module)) for one in EXTRAS[extra]), module
    assert set(PURPOSES) == set(MODULES.values()) <= set(EXTRAS)
    (everything,) = EXTRAS["all"]
    assert all(name in everything for name in EXTRAS if name not in ("all", "dev", "docs"))


def test_a_module_of_no_extra_is_a_fault_of_the_program() -> None:
    assert not_installed(ModuleNotFoundError("No module named 'hil.nowhere'", name="hil.nowhere")) is None


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a base install has run a short plan."""
    place = tmp_path_factory.mktemp("base")
    (place / "short.yaml").write_text(PLAN)
    ran = hil("run", "short.yaml", "--out", "out", cwd=place)
    assert ran.returncode == 0, ran.stderr
    return place


@pytest.mark.slow
def test_a_base_install_runs_a_plan_and_writes_its_reports(folder: Path) -> None:
    assert {"report.html", "report.pdf", "result.json"} <= {file.name for file in (folder / "out").iterdir()}
    checked = hil("check", "short.yaml", cwd=folder)
    assert checked.returncode == 0, checked.stderr
    assert "no margins of the loops" in checked.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["identify", "out/recording.mcap"], "analysis"),
        (["run", "commissioning", "--out", "elsewhere"], "analysis"),
        (["export", "out/recording.mcap", "--out", "out.csv"], "parquet"),
        (["export", "out/recording.mcap", "--out", "out.mf4"], "mdf"),
        (["serve", "--data", "data"], "service"),
        (["export", str(ROOT / "benches" / "three_inertia.toml"), "--out", "a.fmu"], "fmu"),
    ],
)
def test_what_is_left_out_names_its_extra(arguments: list[str], extra: str, folder: Path) -> None:
    told = hil(*arguments, cwd=folder)
    assert (told.returncode, f"pip install 'eaxle-hil[{extra}]'" in told.stderr) == (2, True), told.stderr
    assert "Traceback" not in told.stderr
    assert not (folder / "elsewhere").exists()
