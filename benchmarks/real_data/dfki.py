"""A pendulum on a motor that swings up (torque_limited_simple_pendulum, DFKI Underactuated Lab; BSD-3)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, one_mass, torque_and_speed
from hil.core.errors import BadInputError
from hil.core.recording import Recording

_FIT = ("control_method_ddp", "control_method_direct_collocation")
_HELD, _UPRIGHT_S = "control_method_energy_shaping", 3.8  # later it passes the unstable top again and again


def _file(method: str) -> str:
    return f"{method}/data_measured.csv"


def _recording(path: Path) -> Recording:
    try:
        rows = path.read_text(encoding="utf-8").splitlines()[1:] or ["no rows"]
        data: Array = np.asarray(np.loadtxt(rows, delimiter=",", ndmin=2), dtype=np.float64)
    except (OSError, ValueError) as error:
        raise BadInputError(f"not a table of numbers ({error})", where=str(path)) from error
    if data.shape[1] < 4:
        raise BadInputError(f"{data.shape[1]} columns where four are meant", where=str(path))
    time_s, _, speed, torque = data[:, :4].T
    return torque_and_speed(path, time_s, torque, speed)


def _read(directory: Path) -> Measured:
    fit, held = ([_recording(directory / _file(one)) for one in some] for some in (_FIT, (_HELD,)))
    return Measured({"no gravity": one_mass(0.17, 0.03)}, fit, [one.between(0.0, _UPRIGHT_S) for one in held])


DFKI = DataSet(
    "dfki",
    tuple(_file(method) for method in (*_FIT, _HELD)),
    "gravity of 3.49 N m, which here is a ripple of order 1, and coulomb_friction 0.187 N m (own fit)",
    _read,
    hidden=("motor_order_ripple",),
    beside=("coulomb_friction", "viscous_drag"),
)
