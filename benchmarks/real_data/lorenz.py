"""A servo motor under position control, triangles of speed to 60 rad/s (repository Lorenz_Friction)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, one_mass, torque_and_speed
from hil.core.errors import BadInputError
from hil.core.recording import Recording

_SAMPLE_S = 1e-3
_SPEED, _TORQUE = 1, 4  # columns: position, speed, their commands, torque command
# the authors' other series hold the controller's part of the torque without what is fed forward
_FIT, _HELD = (1, 2, 3, 4), (9, 10)


def _file(number: int) -> str:
    return f"Lorenz_Jm_{number}.txt"


def _recording(path: Path) -> Recording:
    try:
        data: Array = np.asarray(np.loadtxt(path, ndmin=2), dtype=np.float64)
    except (OSError, ValueError) as error:
        raise BadInputError(f"not a table of numbers ({error})", where=str(path)) from error
    if data.shape[1] != 5:
        raise BadInputError(f"{data.shape[1]} columns where five are meant", where=str(path))
    time_s = np.arange(len(data), dtype=np.float64) * _SAMPLE_S
    return torque_and_speed(path, time_s, data[:, _TORQUE], data[:, _SPEED])


def _read(directory: Path) -> Measured:
    fit, held = ([_recording(directory / _file(n)) for n in numbers] for numbers in (_FIT, _HELD))
    # what suits the first three recordings best where no one thinks of dry friction
    return Measured({"linear": one_mass(3.474e-4, 1.240e-3)}, fit, held)


LORENZ = DataSet(
    "lorenz",
    tuple(_file(n) for n in (*_FIT, *_HELD)),
    "coulomb_friction 0.030 N m, offset -0.004 N m, inertia 1.92e-4 kg m2: leaves 5 % (own fit)",
    _read,
)
