"""The wheel alone: built, installed away from the repository, used from a folder of a user's own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[1]
PLAN = """
name: mine
steps:
  - set_controller: {file: my_controller.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.2}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 150, before_s: 0.2, after_s: 1}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(directory)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=120)
    (made,) = directory.glob("*.whl")
    return made


@pytest.fixture(scope="module")
def hil(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """`hil` of an environment that has the wheel and the dependencies, and nothing of the repository."""
    home = tmp_path_factory.mktemp("environment")
    venv.create(home, with_pip=False)
    site = home / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"
    # A folder named in a .pth file lends its packages; its own .pth files (the editable repository) stay out.
    (site / "dependencies.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    script = home / "bin" / "hil"
    script.write_text(f"#!{home / 'bin' / 'python'}\nfrom hil.cli import main\nmain()\n")
    script.chmod(0o755)
    return script


def test_the_wheel_holds_the_packages_the_licence_and_no_tests(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names}
    packages = {"hil", "drivers", "test_plans", "reports", "sim_backend", "benches"}
    assert {top for top in tops if not top.endswith(".dist-info")} == packages
    assert any(name.endswith("licenses/LICENSE") for name in names)
    for needed in ("benches/rmcu.dbc", "reports/templates/report.typ", "test_plans/library/acceptance.yaml"):
        assert needed in names


OWN_TEST = """
import pytest


def test_keeps_its_limit(bench):
    ran = bench.run("tip_in.plan.yaml")
    ran.check()
    assert ran["s.peak_shaft_torque"].value < 400
    assert abs(ran.recording["motor_speed_rad_s"]).max() < 700


def test_does_not_keep_half_of_it(bench):
    bench.run("strict.plan.yaml").check()
"""


@pytest.mark.slow
def test_a_repo_of_a_users_own_is_red_and_green_as_it_should_be(hil: Path, tmp_path: Path) -> None:
    plan = PLAN.replace("name: mine", "name: tip_in").replace("my_controller", "phase_stabilization")
    (tmp_path / "tip_in.plan.yaml").write_text(plan)
    (tmp_path / "strict.plan.yaml").write_text(plan.replace("upper: 400", "upper: 10"))
    (tmp_path / "test_own.py").write_text(OWN_TEST)
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    command = [str(hil.parent / "python"), "-m", "pytest", "-rA", "--bench", "sim", "--bench-out", "out"]
    done = subprocess.run(
        [*command, "--junitxml", "junit.xml", "-p", "no:cacheprovider"],
        cwd=tmp_path, capture_output=True, text=True, timeout=600, env=environment, check=False,
    )  # fmt: skip
    assert done.returncode == 1, done.stdout + done.stderr
    lines = {line.split(" - ")[0] for line in done.stdout.splitlines()}
    for green in (
        "tip_in.plan.yaml::run",
        "tip_in.plan.yaml::s.peak_shaft_torque",
        "strict.plan.yaml::safe_state",
    ):
        assert f"PASSED {green}" in lines
    assert "PASSED test_own.py::test_keeps_its_limit" in lines
    assert {line for line in lines if line.startswith(("FAILED", "ERROR"))} == {
        "FAILED strict.plan.yaml::s.peak_shaft_torque",
        "FAILED test_own.py::test_does_not_keep_half_of_it",
    }
    assert "allowed is ≤" in done.stdout
    cases = {
        case.get("classname"): case for case in ElementTree.parse(tmp_path / "junit.xml").iter("testcase")
    }
    named = {p.get("name"): p.get("value") for p in cases["test_own"].iter("property")}
    assert named["s.peak_shaft_torque.verdict"] == "fail"
    assert float(str(named["s.peak_shaft_torque.value"])) > 10
    assert len(list((tmp_path / "out").glob("*/recording.mcap"))) == 2


@pytest.mark.slow
def test_a_users_own_plan_and_bench_run_from_an_empty_folder(hil: Path, tmp_path: Path) -> None:
    for name in ("rmcu.dbc", "rcs_dyno.eds", "three_inertia.toml", "sim.toml"):
        shutil.copy(ROOT / "benches" / name, tmp_path)
    bench = (
        (tmp_path / "sim.toml")
        .read_text()
        .replace('name = "sim"', 'name = "mine"')
        .replace('"sim/', '"mine/')
    )
    (tmp_path / "my_bench.toml").write_text(bench)
    shutil.copy(
        ROOT / "test_plans/library/controllers/phase_stabilization.toml", tmp_path / "my_controller.toml"
    )
    (tmp_path / "mine.yaml").write_text(PLAN)
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    command = [str(hil), "run", "mine.yaml", "--bench", "my_bench.toml", "--json"]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=600, env=environment, check=False
    )
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert (result["verdict"], result["bench"]) == ("pass", "mine")
    assert set(result["files"]) == {"recording", "html", "pdf", "junit"}
    shown = [str(hil.parent / "python"), "-c", "import hil, drivers; print(hil.__file__, drivers.__file__)"]
    where = subprocess.run(shown, cwd=tmp_path, capture_output=True, text=True, check=True, env=environment)
    assert str(ROOT) not in where.stdout
