"""A short plan with two controllers, and trials of it."""

from pathlib import Path

from hil.analysis.tuning import SpeedLoops, Trial, channels_needed, draws_of, driven_by, free_from_toml
from hil.core.controller import load_controller
from hil.core.model import load_model
from hil.engine.prediction.batch_prediction import BatchPrediction
from test_plans import plan_from_text
from tests.benches_for_tests import SIM

MODEL = load_model(SIM.simulation.model)
STEP = "quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.8"
PLAN = f"""
name: short
steps:
  - set_controller: {{file: gain_stabilization.toml}}
  - hold_speed: {{speed_km_h: 0, duration_s: 0.1}}
  - step: {{segment: gain, {STEP}}}
  - set_controller: {{file: phase_stabilization.toml}}
  - hold_speed: {{speed_km_h: 3, duration_s: 0.1}}
  - step: {{segment: phase, {STEP}}}
criteria:
  - {{segment: gain, metric: peak_shaft_torque, upper: 723}}
  - {{segment: phase, metric: peak_shaft_torque, upper: 400}}
  - {{segment: phase, metric: band_energy, channel: motor_speed_rad_s, from_s: 0, to_s: 0.8, from_hz: 3,
      to_hz: 20, upper: 1}}
  - {{segment: phase, metric: peak_shaft_torque, below: gain}}
  - {{segment: phase, metric: overshoot_shaft_torque}}
"""
#: Tests of how it searches let everything go that a tuning keeps; what it keeps has tests of its own.
LET_GO = """
[keep]
may_worsen = ["response_time", "steady_error", "torque_effort", "stability", "criteria"]
"""
FREE = f"""
[free]
lead_deg = [0.0, 75.0]
feed_forward_time_s = [0.03, 0.2]
{LET_GO}
[tolerance]
vehicle_inertia = 0.1
dead_time_s = 0.001
backlash_rad = 0.01
order_phase = true
sensor_noise = 1.0
"""


def trial_of(free_text=FREE, *, draws=0, seed=0, model=MODEL, plan_text=PLAN):
    plan, free = plan_from_text(plan_text, "short.yaml", Path()), free_from_toml(free_text, "free.toml")
    driven = driven_by(plan)
    start = load_controller(driven.file)
    cars = draws_of(model, free.tolerance, draws, seed)
    channels = channels_needed((*driven.criteria, *plan.device_criteria), free)
    return Trial(
        plan,
        driven,
        free,
        start,
        cars,
        SpeedLoops([car.model for car in cars], start.sample_time_s),
        BatchPrediction(plan, SIM, driven.file, channels),
    )
