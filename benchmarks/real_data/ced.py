"""Coupled electric drives: two motors and a pulley on one belt (T. Wigren, M. Schoukens 2017)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, matlab
from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import replay

_FILE = "DATAUNIF.MAT"
_SETS = (("u11", "z11"), ("u12", "z12"))  # low and high amplitude
_SAMPLE_S = 0.02
_FIT = 400  # samples; the rest is the official test, of which the first `_FIRST` may set a state
_FIRST = 10
_WHEEL = OUTPUTS[1]
# linear, both sets at once, on the magnitude that is measured (own fit); volts stand for N m
_NUMBERS = {
    "motor_inertia": 0.09476,
    "gear_ratio": 1.0,
    "shaft_stiffness": 32.73,
    "shaft_damping": 1e-6,
    "vehicle_inertia": 0.1521,
    "torque_delay": 0.0,
}
_BACK_EMF = 1.123  # N m s/rad on the motors' side


def _start() -> Model:
    return Model("two_inertia", dict(_NUMBERS))


def _sets(path: Path) -> list[tuple[Recording, Array]]:
    """The voltage of each set as a torque, with the pulley's speed and its magnitude as measured.

    The pulse counter does not see a direction: it is that of the linear model there.
    """
    data = matlab(path, [name for pair in _SETS for name in pair])
    found = []
    for voltage, magnitude in _SETS:
        torque, seen = data[voltage].ravel(), data[magnitude].ravel()
        time_s = _SAMPLE_S * np.arange(len(torque), dtype=np.float64)
        drag = EffectUse("viscous_drag", {"coefficient_nms_rad": _BACK_EMF})
        still = Recording({TIME: time_s, INPUT: torque, _WHEEL: np.zeros(len(torque))}, path)
        linear = replay(Model("two_inertia", dict(_NUMBERS), (drag,)), still)[_WHEEL]
        speed = np.where(linear < 0.0, -seen, seen)
        recording = Recording({TIME: time_s, INPUT: torque, _WHEEL: speed}, path.with_stem(voltage))
        found.append((recording, seen))
    return found


def _read(directory: Path) -> Measured:
    sets = [recording for recording, _ in _sets(directory / _FILE)]
    split, end = _SAMPLE_S * _FIT, float(sets[0].time_s[-1])
    fit, held = ([one.between(*span) for one in sets] for span in ((0.0, split), (split, end)))
    return Measured({"linear, no back-EMF": _start()}, fit, held)


def _official(directory: Path, model: Model) -> str:
    """Root mean square error of the magnitude in the official window, simulated from rest at the start."""
    errors = []
    for recording, seen in _sets(directory / _FILE):
        error = np.abs(replay(model, recording)[_WHEEL]) - seen
        errors.append(float(np.sqrt(np.mean(error[_FIT + _FIRST :] ** 2))))
    return f"official window: rmse {errors[0]:.3f} and {errors[1]:.3f} ticks/s"


CED = DataSet(
    "ced",
    (_FILE,),
    "viscous_drag (back-EMF); speed that grows with the square of the voltage has no name; "
    "the linear model leaves 0.169 and 0.278 ticks/s in the official window (own fit)",
    _read,
    hidden=(),
    beside=("viscous_drag", "coulomb_friction", "load_coulomb_friction", "load_viscous_drag"),
    official=_official,
)
