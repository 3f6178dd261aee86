"""Many models at once: forces that are known before the motion is, and those that are not."""

from dataclasses import replace

import numpy as np
import pytest

from hil.core.model import EffectUse
from hil.core.runtime import thread_map
from hil.plant import (
    SENSOR_DELAY,
    SENSOR_GAIN,
    SENSOR_OFFSET,
    SENSOR_STEP,
    _batch_simulation,
    ideal_sensors,
    pack,
    simulate_many,
)
from tests.hil.analysis.diagnosis.one_recording import MODEL

RIPPLE = EffectUse("wheel_order_disturbance", {"order": 3.0, "amplitude_nm": 8.0, "phase_rad": 0.4})
FRICTION = EffectUse("coulomb_friction", {"torque_nm": 0.4})
NEXT_TO_NOTHING = EffectUse("shaft_cubic_stiffness", {"coefficient_nm_rad3": 1e-9})


@pytest.mark.parametrize("others", [(), (FRICTION,)], ids=["alone", "with friction"])
def test_a_ripple_of_a_measured_angle_moves_the_axle_as_one_of_a_force_that_hangs_on_the_motion(
    others: tuple[EffectUse, ...],
) -> None:
    time = np.arange(8000) * 1e-3
    torque = 20.0 + 30.0 * np.sin(4.0 * time)
    angles = np.column_stack([2.0 * time**2, 16.0 * time**2])
    shown = []
    for more in ((), (NEXT_TO_NOTHING,)):
        model = replace(MODEL, effects=(RIPPLE, *others, *more))
        parameters, start = pack(model)[None], np.zeros((1, 3))
        shown.append(simulate_many(parameters, torque, 1e-3, start, ideal_sensors(1), 4, angles)[0])
    assert np.std(shown[0][:, 2]) > 10.0
    np.testing.assert_allclose(shown[0], shown[1], rtol=1e-9, atol=1e-9)


def test_models_alike_but_for_their_sensors_show_what_each_shows_alone() -> None:
    """They move once for all: each sensor has to read that motion, whatever stood before it."""
    time = np.arange(4000) * 1e-3
    torque = 20.0 + 30.0 * np.sin(4.0 * time)
    plain, other = pack(MODEL), pack(replace(MODEL, effects=(FRICTION,)))
    parameters = np.stack([plain, plain, plain, other, other, plain, plain])
    starts = np.zeros((len(parameters), 3))
    starts[6] = 8.0, 1.0, 5.0
    sensors = ideal_sensors(len(parameters))
    sensors[1, :, SENSOR_GAIN], sensors[2, :, SENSOR_DELAY] = 1.1, 2.5e-3
    sensors[4, :, SENSOR_OFFSET], sensors[5, :, SENSOR_STEP] = 3.0, 0.5
    shown = simulate_many(parameters, torque, 1e-3, starts, sensors, 4)
    for index in range(len(parameters)):
        one = slice(index, index + 1)
        alone = simulate_many(parameters[one], torque, 1e-3, starts[one], sensors[one], 4)
        np.testing.assert_array_equal(shown[one], alone)
    assert len({one.tobytes() for one in shown}) == len(shown)


def test_on_however_many_threads_models_move_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    time = np.arange(4000) * 1e-3
    parameters = np.stack([pack(replace(MODEL, effects=(FRICTION,)))] * 7)
    parameters[:, 0] *= 1.0 + 1e-3 * np.arange(7)
    given = parameters, 30.0 * np.sin(4.0 * time), 1e-3, np.zeros((7, 3)), ideal_sensors(7)
    shown = []
    for threads in (1, 3):
        monkeypatch.setattr(thread_map, "threads", lambda threads=threads: threads)
        monkeypatch.setattr(_batch_simulation, "threads", lambda threads=threads: threads)
        thread_map._pool.cache_clear()
        shown.append(simulate_many(*given))
    np.testing.assert_array_equal(shown[0], shown[1])
