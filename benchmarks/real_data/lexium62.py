"""Lexium 62 servo drive with a load disc and emulated friction (trace of a drives lab)."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, one_mass, torque_and_speed
from hil.core.errors import BadInputError
from hil.core.recording import Recording

_FILE = "JLoadWithFriction.trace"
_SPEED, _CURRENT = ":Velocity", "Current_with_Friction"  # names end so; degrees per second, milliamperes
_INERTIA = (0.205 + 1.8684) * 1e-4  # kg m2: motor by its data sheet, disc by its dimensions
_DRAG = 1.8e-4  # N m s/rad, from the trace without friction
_HELD_FROM_S = 3.6  # one change of speed up and one down before it, one each after it


def _torque_nm(current_ma: Array) -> Array:
    """Torque constant that falls as the iron saturates, as the authors fit it to the data sheet."""
    current_a = current_ma * 1e-3
    return np.asarray((0.795915429599640 - 0.005598040685760 * current_a**2) * current_a)


def _variables(path: Path) -> dict[str, tuple[Array, Array]]:
    """(time in s, values) of each variable in a trace file: UTF-16 XML, microseconds of an own clock each."""
    try:
        root = ElementTree.fromstring(path.read_bytes().decode("utf-16").encode())
        return {
            str(one.get("VarName")): (
                1e-6 * np.array((one.findtext("Timestamps") or "").split(","), dtype=np.float64),
                np.array((one.findtext("Values") or "").split(","), dtype=np.float64),
            )
            for one in root.iter("TraceVariable")
        }
    except (OSError, ValueError, ElementTree.ParseError) as error:
        raise BadInputError(f"not a trace of the drive ({error})", where=str(path)) from error


def _recording(path: Path) -> Recording:
    """Speed at its own stamps, torque of the current that is read a microsecond later."""
    variables = _variables(path)
    speed, current = (
        next((v for name, v in variables.items() if name.endswith(end)), None) for end in (_SPEED, _CURRENT)
    )
    if speed is None or current is None:
        raise BadInputError(f"no variable that ends in {_SPEED} or {_CURRENT}", where=str(path))
    return torque_and_speed(path, speed[0], _torque_nm(current[1]), np.radians(speed[1]))


def _read(directory: Path) -> Measured:
    whole = _recording(directory / _FILE)
    fit, held = whole.between(0.0, _HELD_FROM_S), whole.between(_HELD_FROM_S, float(whole.time_s[-1]))
    held.source = directory / f"end of {_FILE}"
    return Measured({"data sheet": one_mass(_INERTIA, _DRAG)}, [fit], [held])


LEXIUM62 = DataSet(
    "lexium62",
    (_FILE,),
    "coulomb_friction 0.72 to 0.75 N m, drag 1.8e-3 to 2.0e-3 N m s/rad (authors' least squares; own fit)",
    _read,
)
