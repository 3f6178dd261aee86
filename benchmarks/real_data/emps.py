"""EMPS: a positioning axis with a ball screw, in closed loop (Janot, Gautier, Brunot 2019)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import DataSet, Measured, matlab, one_mass
from hil.core.channels import INPUT, MOTOR_ANGLE, TIME
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import replay

_FIT, _HELD = "DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"
_FIRST = 20  # samples of the test that may set a state


def _recording(path: Path) -> Recording:
    """Force by drive voltage times gain, in N; the position as its encoder gives it, in m.

    The force pulses of the second file are part of its drive voltage: its authors' own script leaves them
    out of the force that it explains by mass and friction.
    """
    data = matlab(path, ("t", "qm", "vir", "gtau"))
    time_s, position_m, voltage = (data[name].ravel() for name in ("t", "qm", "vir"))
    force_n = voltage * float(data["gtau"].item())
    return Recording({TIME: time_s - time_s[0], INPUT: force_n, MOTOR_ANGLE: position_m}, path)


def _read(directory: Path) -> Measured:
    starts = {
        # the authors' mass and viscous friction, found together with the dry friction that is left out here
        "published": one_mass(95.1089, 203.5034),
        # mass and viscous friction that suit the recording best where no one thinks of dry friction
        "linear": one_mass(105.58, 426.54),
    }
    return Measured(starts, [_recording(directory / _FIT)], [_recording(directory / _HELD)])


def _official(directory: Path, model: Model) -> str:
    """Root mean square error of the position of the pulses, simulated from rest where they begin."""
    held = _recording(directory / _HELD)
    error = held[MOTOR_ANGLE] - replay(model, held)[MOTOR_ANGLE]
    return f"official window: position rmse {1e3 * float(np.sqrt(np.mean(error[_FIRST:] ** 2))):.2f} mm"


EMPS = DataSet(
    "emps",
    (_FIT, _HELD),
    "coulomb_friction 20.4 N, offset -3.16 N, mass 95.1 kg, drag 203.5 N s/m (IDIM-LS)",
    _read,
    official=_official,
)
