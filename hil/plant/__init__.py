"""The plant: a model file turned into motion by a compiled kernel."""

from hil.plant._angles import (
    TURNED_OVER_S,
    angle_at,
    angle_of,
    as_read,
    by_angle,
    half_window,
    rounding_step,
    speed_of,
    turned,
)
from hil.plant._batch_simulation import Led, ideal_sensors, simulate_many
from hil.plant._linear import LinearSystem, linear_system, linear_system_of, system
from hil.plant._packed_sets import begins_of, turns
from hil.plant._regulated import Turning, followed, given_outputs, stands, turning_of
from hil.plant._replay import Start, gear_ratio_of, load_of, replay, replayed, simulate
from hil.plant._stability import LONGEST_STEP_S, is_stable, refuse_diverged_state, refuse_too_stiff
from hil.plant._stamps import at_true_times, even_times, held_over, jittered
from hil.plant.sensors import DELAY as SENSOR_DELAY
from hil.plant.sensors import GAIN as SENSOR_GAIN
from hil.plant.sensors import OFFSET as SENSOR_OFFSET
from hil.plant.sensors import STEP as SENSOR_STEP
from hil.plant.sensors import TURNED as SENSOR_TURNED
from hil.plant.sensors import bench_sensor, sensor_of, sensor_response
from hil.plant.slots import GEAR_RATIO, chain_numbers, is_regulated, pack

__all__ = [
    "GEAR_RATIO",
    "LONGEST_STEP_S",
    "SENSOR_DELAY",
    "SENSOR_GAIN",
    "SENSOR_OFFSET",
    "SENSOR_STEP",
    "SENSOR_TURNED",
    "TURNED_OVER_S",
    "Led",
    "LinearSystem",
    "Start",
    "Turning",
    "angle_at",
    "angle_of",
    "as_read",
    "at_true_times",
    "begins_of",
    "bench_sensor",
    "by_angle",
    "chain_numbers",
    "even_times",
    "followed",
    "gear_ratio_of",
    "given_outputs",
    "half_window",
    "held_over",
    "ideal_sensors",
    "is_regulated",
    "is_stable",
    "jittered",
    "linear_system",
    "linear_system_of",
    "load_of",
    "pack",
    "refuse_diverged_state",
    "refuse_too_stiff",
    "replay",
    "replayed",
    "rounding_step",
    "sensor_of",
    "sensor_response",
    "simulate",
    "simulate_many",
    "speed_of",
    "stands",
    "system",
    "turned",
    "turning_of",
    "turns",
]
