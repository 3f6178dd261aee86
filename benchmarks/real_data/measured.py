"""A data set as the diagnosis is given it: model files to start from, recordings, recordings held out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from hil.core.channels import INPUT, OUTPUTS, TIME
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording

Array = npt.NDArray[np.float64]

SPEED = OUTPUTS[0]


@dataclass(frozen=True)
class Measured:
    """`starts`: models that a user would begin with, by what they come from."""

    starts: dict[str, Model]
    recordings: list[Recording]
    holdout: list[Recording]


@dataclass(frozen=True)
class DataSet:
    """A published data set.

    `files` must be in its directory (`directory`, or one named as it);
    `expected` is what its authors, or a fit by another program, found;
    `read` makes recordings of the directory; `hidden` must be named, `beside` may be; `official` says what a
    model reaches in the measure of the benchmark that the data are from.
    """

    name: str
    files: tuple[str, ...]
    expected: str
    read: Callable[[Path], Measured]
    directory: str = ""
    hidden: tuple[str, ...] = ("coulomb_friction",)
    beside: tuple[str, ...] = ()
    official: Callable[[Path, Model], str] = lambda directory, model: ""

    def place(self, data: Path) -> Path:
        """Where its files are."""
        return data / (self.directory or self.name)


def one_mass(inertia: float, drag: float) -> Model:
    """One rotating mass in kg m² with viscous drag in N m s/rad, no gear.

    A carriage in metres is the same equation in other units: kg for kg m², N for N m, m/s for rad/s. A rigid
    model wants a load as well: a thousandth of the mass, which no recording can tell from the rest.
    """
    parameters = {
        "motor_inertia": 0.999 * inertia,
        "gear_ratio": 1.0,
        "vehicle_inertia": 1e-3 * inertia,
        "viscous_drag": drag,
        "torque_delay": 0.0,
    }
    return Model("rigid", {name: float(f"{value:.6g}") for name, value in parameters.items()})


def torque_and_speed(path: Path, time_s: Array, torque_nm: Array, speed_rad_s: Array) -> Recording:
    """A recording with the torque that acts and the speed of what it moves, samples long each."""
    return Recording({TIME: time_s - time_s[0], INPUT: torque_nm, SPEED: speed_rad_s}, path)


def matlab(path: Path, names: Sequence[str]) -> Mapping[str, Array]:
    """Variables of a MATLAB file, as floats.

    Raises:
        BadInputError: no such file, not MATLAB's, or a variable is missing.
    """
    try:
        found = loadmat(path, variable_names=list(names))
    except (OSError, ValueError, IndexError, NotImplementedError, MatReadError) as error:
        raise BadInputError(f"not a MATLAB file that can be read ({error})", where=str(path)) from error
    missing = [name for name in names if name not in found]
    if missing:
        raise BadInputError(
            f"no variable {', '.join(missing)}", where=str(path), fix="take the file as it is"
        )
    return {name: np.asarray(found[name], dtype=np.float64) for name in names}
