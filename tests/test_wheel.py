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
