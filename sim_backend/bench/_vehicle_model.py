"""The vehicle that the dyno controller simulates: what its nodes' objects say of it, and what they show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from hil.plant.closed_loop import State
from hil.plant.closed_loop import tick as T
from sim_backend.rcs import DynoNode

_MODEL = 0x2000
_SUBINDICES = {"inertia_kg_m2": 1, "rolling_nm": 2, "aero_nms2_rad2": 3, "slip": 4}


def preset_vehicle(plant: State, dynos: Sequence[DynoNode], wheel_radius_m: float) -> None:
    """Have every node's objects say what the plant's vehicle is at first."""
    for node in dynos:
        for subindex, value in enumerate((*plant.vehicle, 0.0, wheel_radius_m, 0.0), 1):
            node.preset(_MODEL, subindex, value)


def set_vehicle(plant: State, dynos: Sequence[DynoNode], values: Mapping[str, float]) -> None:
    """Give the vehicle other values: those of the nodes' objects, or by other names the road's friction."""
    friction = {name: value for name, value in values.items() if name not in _SUBINDICES}
    for name in values.keys() - friction.keys():
        for node in dynos:
            node.preset(_MODEL, _SUBINDICES[name], values[name])
    take_vehicle_model(plant, dynos[0])
    plant.set_vehicle(**friction)


def take_vehicle_model(plant: State, node: DynoNode) -> None:
    """Let the plant's vehicle be what a node's objects say."""
    inertia, rolling, aero, slip, radius, initial = (node.number(_MODEL, i) for i in range(1, 7))
    plant.set_vehicle(
        inertia_kg_m2=inertia,
        rolling_nm=rolling,
        aero_nms2_rad2=aero,
        slip=slip,
        wheel_radius_m=radius,
        initial_speed_m_s=initial,
    )


def show_measured(row: npt.NDArray[np.float64], dynos: Sequence[DynoNode]) -> None:
    """A sample of the plant, to whoever reads it of the wheels' nodes by SDO."""
    for side, node in enumerate(dynos[:2]):
        node.measure(
            row[T.WHEEL_LEFT + side],
            row[T.SHAFT_LEFT + side],
            row[T.VEHICLE_SPEED],
            row[T.LOAD_LEFT + side],
        )
