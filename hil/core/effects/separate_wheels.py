"""Left and right half shafts, wheels and tyres of their own, behind a differential.

The lumped numbers stay those of both sides together: each half shaft and each tyre has half of the stiffness
and of the damping, each wheel half of the inertia. An open differential gives both shafts the same torque,
whatever the wheels do. One with friction holds its side gears together until their torques differ by its
friction. On a road that is alike on both sides the axle is the lumped one. `hil.plant.sides`
has the equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law


def _together(values: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]]) -> tuple[str, str] | None:
    apart = values["friction_left"] != 1.0 or values["friction_right"] != 1.0
    if apart and not others.get("tyre_friction", {}).get("peak_nm"):
        return (
            "friction_left and friction_right are shares of what 'tyre_friction' has, and the model has none",
            'add [[effects]] id = "tyre_friction" with a peak_nm above 0',
        )
    return None


EFFECT = Effect(
    id="separate_wheels",
    title="Separate wheels",
    stage=Stage.TYRE,
    summary=(
        "Left and right half shafts, wheels and tyres behind a differential, open or with friction; the "
        "road's friction may differ from side to side."
    ),
    signature="The speeds of left and right wheel part where one tyre slides.",
    shown_by="A torque step on a road that is slippery on one side.",
    parameters=(
        Parameter(
            "differential_friction_nm",
            "N m",
            0.0,
            1e5,
            "by which the torques of both shafts can differ; 0: open",
            optional=True,
        ),
        Parameter(
            "friction_left",
            "1",
            1e-3,
            10.0,
            "friction under the left tyre, a share of `tyre_friction`'s",
            optional=True,
            default=1.0,
        ),
        Parameter(
            "friction_right", "1", 1e-3, 10.0, "likewise under the right one", optional=True, default=1.0
        ),
    ),
    needs=("three_inertia",),
    law=Law(sides=True),
    together=_together,
    similar=("tyre_friction",),
)
