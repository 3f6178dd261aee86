"""EMPS: a positioning axis with a ball screw, in closed loop (Janot, Gautier, Brunot 2019)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid

from benchmarks.real_data.measured import SPEED, DataSet, Measured, matlab, one_mass, torque_and_speed
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import replay

_FIT, _HELD = "DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"
_FIRST = 20  # samples of the test that may set a state


def _recording(path: Path) -> Recording:
    """Force by drive voltage times gain, in N; speed by central differences of the encoder, in m/s.

    The force pulses of the second file are part of its drive voltage: its authors' own script leaves them
    out of the force that it explains by mass and friction.
    """
    data = matlab(path, ("t", "qm", "vir", "gtau"))
    time_s, position_m, voltage = (data[name].ravel() for name in ("t", "qm", "vir"))
    force_n = voltage * float(data["gtau"].item())
    return torque_and_speed(path, time_s, force_n, np.gradient(position_m, time_s))


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
    measured = matlab(directory / _HELD, ("qm",))["qm"].ravel()
    moved = cumulative_trapezoid(replay(model, held)[SPEED], held.time_s, initial=0)
    error = measured - measured[0] - moved
    return f"official window: position rmse {1e3 * float(np.sqrt(np.mean(error[_FIRST:] ** 2))):.2f} mm"


EMPS = DataSet(
    "emps",
    (_FIT, _HELD),
    "coulomb_friction 20.4 N, offset -3.16 N, mass 95.1 kg, drag 203.5 N s/m (IDIM-LS)",
    _read,
    official=_official,
)
