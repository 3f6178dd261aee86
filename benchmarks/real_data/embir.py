"""A motor for a leg, random torque, read every 2.7 to 10 ms (repository actuator-dynamometer)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real_data.measured import Array, DataSet, Measured, one_mass, torque_and_speed
from hil.core.errors import BadInputError
from hil.core.recording import Recording

_FILE = "futek_test_06_05_2021_17-09-17.csv"
_TIME, _TORQUE, _SPEED = "time [s]", "a1 torque [Nm]", "a1 velocity [rad/s]"
_FIT_SHARE = 2.0 / 3.0


def _columns(path: Path) -> tuple[Array, Array, Array]:
    """Time, torque by the motor's current and speed, below the remarks and the names of columns."""
    try:
        lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
        names = lines[0].split(",")
        wanted = [names.index(name) for name in (_TIME, _TORQUE, _SPEED)]
        data = np.array([[float(line.split(",")[i]) for i in wanted] for line in lines[1:]])
    except (OSError, ValueError, IndexError) as error:
        raise BadInputError(f"not a log of the dynamometer ({error})", where=str(path)) from error
    time_s, torque_nm, speed_rad_s = data.T
    return time_s, torque_nm, speed_rad_s


def _read(directory: Path) -> Measured:
    path = directory / _FILE
    columns = _columns(path)
    until = round(_FIT_SHARE * len(columns[0]))

    def part(rows: slice) -> Recording:
        return torque_and_speed(path, *(column[rows] for column in columns))

    fit, held = part(slice(until)), part(slice(until, None))
    held.source = directory / f"end of {_FILE}"
    # one mass and drag, as the authors fit them; the numbers are of a fit of our own
    return Measured({"first order": one_mass(4.82e-4, 9.3e-3)}, [fit], [held])


EMBIR = DataSet(
    "embir",
    (_FILE,),
    "unknown as a whole: coulomb_friction 0.045 N m leaves 15 of 20 % (own fit)",
    _read,
    hidden=(),
)
