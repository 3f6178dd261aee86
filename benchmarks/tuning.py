"""Closed-loop evaluations of the acceptance plan: of a search, by python-control, over the wire."""

from __future__ import annotations

import resource
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

from benchmarks.answers import refuse_no_numbers
from hil.analysis.tuning import KEPT, Pool, SpeedLoops, Trial, channels_needed, draws_of, driven_by, read_free
from hil.core.controller import load_controller
from hil.core.model import load_model
from hil.engine import RunRequest, load_bench, run_plan
from hil.engine.prediction.batch_prediction import BatchPrediction
from test_plans import load_plan

EVALUATIONS = 2000


def acceptance_trial(draws: int = 0, plan: str | Path = "acceptance", *, keeping: bool = True) -> Trial:
    """The acceptance plan on the default bench; `keeping`: with what may not get worse than the start."""
    loaded, bench, free = load_plan(plan), load_bench("sim"), read_free(None)
    if not keeping:
        free = free.model_copy(update={"keep": free.keep.model_copy(update={"may_worsen": KEPT})})
    assert bench.simulation is not None
    driven = driven_by(loaded)
    start = load_controller(driven.file)
    cars = draws_of(load_model(bench.simulation.model), free.tolerance, draws, 0)
    channels = channels_needed((*driven.criteria, *loaded.device_criteria), free)
    loops = SpeedLoops([car.model for car in cars], start.sample_time_s)
    return Trial(
        loaded, driven, free, start, cars, loops, BatchPrediction(loaded, bench, driven.file, channels)
    )


def python_control_s() -> float:
    """Processor time of the plan's four steps in python-control: the speed loop alone, linear, sampled.

    Without driving force control, observer, limits, wheel order, sensors and ramps between the steps: less
    than a run is.
    """
    import control

    warnings.simplefilter("ignore")
    trial = acceptance_trial()
    p, wsc, dt = trial.start.plant, trial.start.wsc, trial.start.sample_time_s
    axle = control.sample_system(control.tf(p.motor_speed, p.denominator), dt, "zoh")
    late = control.tf([1.0], [1.0] + [0.0] * 8, dt)
    pi = control.tf([wsc.proportional_gain, wsc.integral_gain], [1.0, 0.0])
    assert wsc.lead is not None
    lead = wsc.lead.gain * control.tf(
        [wsc.lead.time_constant_s, 1.0], [wsc.lead.alpha * wsc.lead.time_constant_s, 1]
    )
    feedback = control.sample_system(pi * lead, dt, "tustin")
    plant = control.tf2ss(axle * late)
    closed = control.feedback(plant, control.tf2ss(feedback))
    torque = np.concatenate([np.zeros(1000), np.full(20_000, 40.0)])
    start = time.process_time()
    for _ in range(4):
        speed = control.forced_response(closed, np.arange(len(torque)) * dt, torque).outputs
    spent_s = time.process_time() - start
    refuse_no_numbers("python-control", speed)
    return spent_s


def wire_s() -> float:
    """Processor time of one run over the simulated bench's wire, without reports."""
    plan, bench = load_plan("acceptance"), load_bench("sim")
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time() + _children_s()
        run_plan(RunRequest(plan=plan, bench=bench, out=Path(folder) / "run"))
        return time.process_time() + _children_s() - start


def main() -> None:
    """Print seconds for one and for 2,000 evaluations; processor time depends little on who else works."""
    trial = acceptance_trial()
    random = np.random.default_rng(0)
    leads = [{"lead_deg": float(angle)} for angle in random.uniform(20, 45, EVALUATIONS)]
    trial.tried(leads[0], 0)
    cpu = min(_cpu_s(trial, values) for values in leads[:10])
    before = _children_s()
    with Pool(trial) as pool:
        pool.tried([(values, 0) for values in leads[:8]])  # processes begin
        start = time.perf_counter()
        tried = pool.tried([(values, 0) for values in leads])
        whole = time.perf_counter() - start
    spent = _children_s() - before
    assert all(one.margins for one in tried)
    wire_s()
    rows = (
        ("hil tune, one, processor time", cpu),
        (f"hil tune, {EVALUATIONS}, processor time, processes started and ended", spent),
        (f"the same by the clock, {pool.processes} processes", whole),
        ("python-control, speed loop alone, linear, one, processor time", python_control_s()),
        ("over the simulated wire, one, processor time", wire_s()),
    )
    for name, seconds in rows:
        print(f"{name:<66}{seconds:>10.3f} s")


def _children_s() -> float:
    """Processor time of processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _cpu_s(trial: Trial, values: dict[str, float]) -> float:
    start = time.process_time()
    trial.tried(values, 0)
    return time.process_time() - start


if __name__ == "__main__":
    main()
