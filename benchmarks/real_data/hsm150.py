"""HSM150: two servo motors on one shaft, steps of torque, speed rounded to 0.63 rad/s (R. Malik)."""

from __future__ import annotations

from pathlib import Path

from benchmarks.real_data.measured import DataSet, Measured, matlab, one_mass, torque_and_speed
from hil.core.recording import Recording

_STEPS = ("neg_0.045", "neg_0.04", "pos_0.065", "pos_0.06")
_TIME, _SPEED, _TORQUE = 0, 3, 4  # columns of `data`, by the authors' README


def _file(step: str, number: int) -> str:
    return f"idf_{step}_{number}.mat"


def _recording(path: Path) -> Recording:
    data = matlab(path, ("data",))["data"]
    return torque_and_speed(path, data[:, _TIME], data[:, _TORQUE], data[:, _SPEED])


def _read(directory: Path) -> Measured:
    catalogue = matlab(directory / _file(_STEPS[0], 1), ("J", "B"))
    # two motors turn together, of which the file states one
    start = one_mass(2.0 * float(catalogue["J"].item()), float(catalogue["B"].item()))
    fit, held = ([_recording(directory / _file(s, n)) for s in _STEPS] for n in (1, 2))
    return Measured({"catalogue": start}, fit, held)


HSM150 = DataSet(
    "hsm150",
    tuple(_file(s, n) for s in _STEPS for n in (1, 2)),
    "coulomb_friction 0.021 N m, offset 0.009 N m, inertia 1.57e-4 kg m2: leaves 9 % (own fit; it warms up)",
    _read,
)
