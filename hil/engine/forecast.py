"""What a plan will do to the axle: the plan carried out on the simulated bench, with nothing to trip."""

from __future__ import annotations

import tempfile
from pathlib import Path

from hil.engine.bench_file import DEFAULT_BENCH, BenchFile, load_bench
from hil.engine.limits import limits_of_channels
from hil.engine.run import RunRequest, run_plan
from test_plans import Plan

_UNLIMITED = 1e9


def forecast(plan: Plan, bench: BenchFile) -> dict[str, tuple[float, float]]:
    """Largest magnitude of each limited channel with its limit, by simulation: {channel: (value, limit)}.

    Only the limits on measured values are lifted for this; those on requests have been checked before.
    A bench without a [simulation] is predicted with the shipped simulated bench's model.

    Raises:
        BadInputError: the plan asks for more than the bench allows.
        HilError: the simulated run failed.
    """
    limits = limits_of_channels(bench.limits)
    default = load_bench(DEFAULT_BENCH)
    measured = ("shaft_torque_nm", "motor_speed_rad_s", "wheel_speed_rad_s", "vehicle_speed_m_s")
    simulated = bench.model_copy(
        update={
            "name": "forecast",
            "limits": bench.limits.model_copy(update=dict.fromkeys(measured, _UNLIMITED)),
            "buses": {
                name: bus.model_copy(
                    update={
                        "interface": "hil-sim",
                        "options": {},
                        "channel": f"forecast/{_role(bench, name)}",
                    }
                )
                for name, bus in bench.buses.items()
            },
            "simulation": bench.simulation or default.simulation,
            "calibration": {},
        }
    )
    with tempfile.TemporaryDirectory() as directory:
        outcome = run_plan(RunRequest(plan, simulated, Path(directory)))
    if outcome.error is not None:
        raise outcome.error
    return {channel: (outcome.largest[channel], limit) for channel, limit in limits.items()}


def _role(bench: BenchFile, bus: str) -> str:
    return "rmcu" if bench.rmcu.bus == bus else "dyno"
