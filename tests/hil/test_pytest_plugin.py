"""What pytest does with plan files, in processes of its own; runs of them are in tests/test_wheel.py."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from hil.engine.bench.bench_file import shipped

PLAN = """
name: short
steps:
  - step: {segment: s, quantity: motor_torque, from_nm: 0, to_nm: 10, before_s: 0.2, after_s: 0.5}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: UPPER, unit: N m}
"""
HEAVY = ("numpy", "numba", "pandas", "pydantic", "can", "hil.core", "test_plans")


def tried(folder: Path, *arguments: str, code: int) -> str:
    command = [sys.executable, "-m", "pytest", "-rA", "-p", "no:cacheprovider", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout


def test_without_a_bench_it_does_nothing_and_imports_nothing(tmp_path: Path) -> None:
    (tmp_path / "short.plan.yaml").write_text(PLAN)
    (tmp_path / "plan.yaml").write_text("not: ours")
    (tmp_path / "test_own.py").write_text(
        f"import sys\ndef test_lean():\n    assert not set({HEAVY!r}) & set(sys.modules)\n"
        "def test_none(bench):\n    raise AssertionError\n"
    )
    said = tried(tmp_path, code=0)
    assert "1 passed, 1 skipped" in said
    assert "no bench: give --bench" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "bench", "told"),
    [
        ("name: short\nsteps:\n  - wiat: {}\n", "sim", "wait"),
        (PLAN.replace("UPPER", "1"), "smi", "did you mean 'sim'?"),
    ],
)
def test_mistakes_of_plan_and_bench_are_told_when_tests_are_collected(
    tmp_path: Path, text: str, bench: str, told: str
) -> None:
    (tmp_path / "plan.yaml").write_text(text)
    said = tried(tmp_path, "--bench", bench, code=2)
    assert told in said
    assert "Traceback" not in said


@pytest.mark.slow
def test_a_second_session_has_folders_of_its_own_or_replaces(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN.replace("UPPER", "500"))
    (tmp_path / "test_own.py").write_text("def test_a(bench):\n    bench.run('plan.yaml').check()\n")
    named = ("--bench", "sim", "--bench-out", "out")
    folders = {"plan_yaml-001", "test_own_py__test_a/plan-001"}
    tried(tmp_path, *named, code=0)
    assert results(tmp_path / "out") == folders
    tried(tmp_path, *named, "--bench-overwrite", code=0)
    assert results(tmp_path / "out") == folders
    tried(tmp_path, *named, code=0)
    assert results(tmp_path / "out") == folders | {name.replace("001", "002") for name in folders}


def results(out: Path) -> set[str]:
    return {str(path.parent.relative_to(out)) for path in out.rglob("result.json")}


@pytest.mark.slow
def test_a_run_that_cannot_begin_leaves_no_folder(tmp_path: Path) -> None:
    (tmp_path / "test_own.py").write_text("def test_a(bench):\n    bench.run('gone')\n")
    assert "there is no plan 'gone'" in tried(tmp_path, "--bench", "sim", "--bench-out", "out", code=1)
    assert not list((tmp_path / "out/test_own_py__test_a").iterdir())


@pytest.mark.slow
def test_hardware_beside_a_plan_is_driven_only_if_it_is_named(tmp_path: Path) -> None:
    hardware = shipped("rear_axle_socketcan.toml")
    text = hardware.read_text("utf-8")
    for name in ("rmcu.dbc", "rcs_dyno.eds"):
        text = text.replace(f'"{name}"', f'"{shipped(name)}"')
    (tmp_path / "bench.toml").write_text(text)
    (tmp_path / "plan.yaml").write_text(PLAN.replace("UPPER", "500"))
    assert "describes hardware, which is driven only if it is named" in tried(tmp_path, code=2)
    (tmp_path / "plan.yaml").unlink()
    (tmp_path / "test_own.py").write_text("def test_a(bench):\n    raise AssertionError('driven')\n")
    said = tried(tmp_path, code=1)
    assert "describes hardware, which is driven only if it is named" in said
    assert "driven'" not in said


@pytest.mark.slow
def test_two_folders_of_ones_own_under_one_root_by_their_own_benches(tmp_path: Path) -> None:
    for name, upper in (("a", "500"), ("b", "1")):
        made = [str(Path(sys.executable).parent / "hil"), "init", str(tmp_path / name)]
        subprocess.run(made, check=True, capture_output=True)
        (tmp_path / name / "plan.yaml").write_text(PLAN.replace("UPPER", upper))
    said = tried(tmp_path, code=1)
    assert "5 passed" in said
    assert "FAILED b/plan.yaml::s.peak_shaft_torque - s.peak_shaft_torque: fail:" in said


@pytest.mark.slow
def test_the_bench_of_an_ini_file_and_a_run_that_cannot_begin(tmp_path: Path) -> None:
    made = [str(Path(sys.executable).parent / "hil"), "init", str(tmp_path / "mine")]
    subprocess.run(made, check=True, capture_output=True)
    (tmp_path / "pytest.ini").write_text("[pytest]\nhil_bench = mine/bench.toml\n")
    (tmp_path / "mine/plan.yaml").unlink()
    low = (
        (tmp_path / "mine/bench.toml")
        .read_text()
        .replace("shaft_torque_nm = 1200.0", "shaft_torque_nm = 1.0")
    )
    (tmp_path / "mine/bench.toml").write_text(low)
    (tmp_path / "short.plan.yaml").write_text(PLAN.replace("UPPER", "500"))
    said = tried(tmp_path, code=1)
    assert "FAILED short.plan.yaml::run" in said
    assert "PASSED short.plan.yaml::safe_state" in said or "SKIPPED" in said
    assert "shaft_torque" in said
