"""The how-to's effect, installed as its reader would: simulated, fitted, named and reported."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hil.core.model import Model, load_model, save_model
from hil.engine.bench.bench_file import shipped

PAGE = Path(__file__).parents[2] / "docs/how-to/own-effect.md"
DT, SHARE = 1e-3, 0.25


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return found[1]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("site")
    (place / "axle_lab.py").write_text(block("python"))
    installed = place / "axle_lab-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: axle_lab\nVersion: 1.0\n")
    points = re.sub(r'project\.entry-points\."(.*?)"', r"\1", block("toml")).replace('"', "")
    (installed / "entry_points.txt").write_text(points)
    return place


def hil(package: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """The command with the package installed; kernels compiled with it go beside it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(package), *sys.path])}
    return subprocess.run(
        [sys.executable, "-c", "from hil.cli import main; main()", *map(str, arguments)],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )


def base() -> Model:
    return load_model(shipped("three_inertia.toml")).with_effects()


def torque() -> np.ndarray:
    t = np.arange(0.0, 20.0, DT)
    return 25.0 * np.sin(2 * np.pi * (0.1 * t + 0.5 * t**2)) + 5.0 * np.sin(2 * np.pi * 0.13 * t)


def measured(noise: bool = True) -> np.ndarray:
    """Motor speed, wheel speed and shaft torque of asymmetric shafts, by an integrator of others."""
    p, u = base().parameters, torque()
    n, late = p["gear_ratio"], round(p["torque_delay"] / DT)

    def shaft(x: np.ndarray) -> float:
        linear = p["shaft_stiffness"] * x[1] + p["shaft_damping"] * (x[0] / n - x[2])
        return float(linear + SHARE * p["shaft_stiffness"] * max(0.0, x[1]))

    def slope(_: float, x: np.ndarray, acting: float) -> list[float]:
        road = p["tyre_stiffness"] * x[3] + p["tyre_damping"] * (x[2] - x[4])
        return [
            (acting - shaft(x) / n) / p["motor_inertia"],
            x[0] / n - x[2],
            (shaft(x) - road) / p["wheel_inertia"],
            x[2] - x[4],
            road / p["vehicle_inertia"],
        ]

    x, rows = np.zeros(5), np.zeros((len(u), 3))
    for k in range(len(u)):
        rows[k] = x[0], x[2], shaft(x)
        acting = u[k - late] if k >= late else 0.0
        answer = solve_ivp(slope, (0.0, DT), x, args=(acting,), rtol=1e-7, atol=1e-9)
        x = answer.y[:, -1]
    random = np.random.default_rng(5)
    return rows + noise * random.normal(size=rows.shape) * np.array([0.05, 0.005, 0.5])


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "chirp.csv"
    u, rows = torque(), measured()
    table = np.column_stack([np.arange(len(u)) * DT, u, rows])
    names = "time_s,motor_torque_ref_nm,motor_speed_rad_s,wheel_speed_rad_s,shaft_torque_nm"
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.7g")
    return path


@pytest.mark.slow
def test_it_is_named_with_its_number_and_reported(package: Path, recording: Path, tmp_path: Path) -> None:
    save_model(base(), tmp_path / "base.toml")
    done = hil(package, "diagnose", "--model", tmp_path / "base.toml", recording, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "out/diagnosis.json").read_text())
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert effect["id"] == "shaft_asymmetry"
    assert effect["parameters"]["share"] == pytest.approx(SHARE, rel=0.05)
    assert "Asymmetric shafts" in (tmp_path / "out/report.html").read_text()
    model = (tmp_path / "out/model.toml").read_text()
    assert "shaft_asymmetry" in model
    shown = hil(
        package,
        "simulate",
        "--model",
        tmp_path / "out/model.toml",
        "--input",
        recording,
        "--out",
        tmp_path / "again.csv",
    )
    assert shown.returncode == 0, shown.stderr
    again = np.loadtxt(tmp_path / "again.csv", delimiter=",", skiprows=1)
    names = (tmp_path / "again.csv").read_text().splitlines()[0].split(",")
    exact = measured(noise=False)[:, 2]
    miss = again[:, names.index("shaft_torque_nm")] - exact
    assert np.std(miss) < 0.02 * np.std(exact)


@pytest.mark.slow
def test_without_the_package_its_model_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(
        shipped("three_inertia.toml").read_text() + '\n[[effects]]\nid = "shaft_asymmetry"\nshare = 0.25\n'
    )
    done = hil(tmp_path, "simulate", "--model", tmp_path / "m.toml", "--input", "x.csv", "--out", "y.csv")
    assert done.returncode != 0
    assert "shaft_asymmetry" in done.stderr


@pytest.mark.slow
def test_a_broken_package_is_said_and_no_traceback(package: Path, tmp_path: Path) -> None:
    points = package / "axle_lab-1.0.dist-info/entry_points.txt"
    for value, said in (("axle_lab:NOTHING", "NOTHING"), ("math:pi", "not an Effect")):
        broken = tmp_path / value.replace(":", "_")
        installed = broken / "axle_lab-1.0.dist-info"
        installed.mkdir(parents=True)
        (installed / "METADATA").write_text((points.parent / "METADATA").read_text())
        (installed / "entry_points.txt").write_text(f"[hil.effects]\nshaft_asymmetry = {value}\n")
        (broken / "axle_lab.py").write_text(block("python"))
        done = hil(broken, "check", "acceptance")
        assert done.returncode != 0
        assert said in done.stderr
        assert "Traceback" not in done.stderr
