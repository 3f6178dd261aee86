"""Identification uses what the axle was asked for and did, not when that was meant, nor stamps of frames."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivers import read_rmcu
from hil.engine import RunRequest, run_plan
from sim_backend.bench import SimulatedBench
from test_plans import load_plan
from tests.benches_for_tests import SIM, sim_bench
from tests.late_stamps import late_bench

_LATEST_MS = 4
REQUEST_ID = read_rmcu(SIM.rmcu.dbc).layouts["RMCU_Request"].id


def identified(bench: Any, out: Path) -> dict[str, tuple[float, float]]:
    """Parameters of the fitted chain with their standard errors."""
    commissioning = load_plan("commissioning")
    until = [step.kind for step in commissioning.steps].index("identify") + 1
    asked = commissioning.model_copy(update={"steps": commissioning.steps[:until], "criteria": ()})
    outcome = run_plan(RunRequest(asked, bench, out))
    assert outcome.error is None
    found = tomllib.loads((out / "physical.toml").read_text())
    errors = found["meta"]["standard_errors"]
    return {name: (found["parameters"][name], error) for name, error in errors.items()}


def jitter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every request reaches the RMCU 0 to 4 ms late from here on, in order."""
    random = np.random.default_rng(7)
    put = SimulatedBench.put

    latest_s: dict[SimulatedBench, float] = {}

    def late(self: SimulatedBench, bus: str, frame_id: int, data: bytes) -> None:
        if bus != "rmcu" or frame_id != REQUEST_ID:
            put(self, bus, frame_id, data)
            return
        due_s = self.now_s() + 1e-3 * int(random.integers(0, _LATEST_MS + 1))
        latest_s[self] = max(due_s, latest_s.get(self, 0.0))
        payload = np.array([int.from_bytes(data, "little")], np.uint64)
        self.put_ahead(bus, frame_id, payload, len(data), np.array([latest_s[self]]))

    monkeypatch.setattr(SimulatedBench, "put", late)


@pytest.mark.parametrize(
    "late",
    [pytest.param("bursts", marks=pytest.mark.slow), pytest.param("outliers", marks=pytest.mark.hunt)],
)
def test_late_requests_and_late_stamps_give_the_same_axle(
    late: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    true = identified(sim_bench("still"), tmp_path / "true")
    jitter(monkeypatch)
    found = identified(late_bench("jitter", late), tmp_path / "late")
    for name, (value, error) in true.items():
        apart = abs(found[name][0] - value) / math.hypot(error, found[name][1])
        print(f"{name}: {value:.6g} {found[name][0]:.6g}, {apart:.2f} standard errors apart")
        assert apart <= 2, (name, found[name], value)
