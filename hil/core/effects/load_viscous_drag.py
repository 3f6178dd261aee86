"""Drag proportional to the speed of the wheel, or of the load where a model has no wheel of its own."""

from __future__ import annotations

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values


def _brakes(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    return values[0] * motion.wheel_speed


EFFECT = Effect(
    id="load_viscous_drag",
    title="Viscous drag on the load",
    stage=Stage.LOAD,
    summary="Drag proportional to wheel speed (to the load's, where the model has two inertias), wheel side.",
    signature="Speed reached falls short, in proportion to speed, and the shafts carry what is lost.",
    shown_by="A coast-down over a wide speed range with the shaft torque recorded.",
    parameters=(
        Parameter("coefficient_nms_rad", "N m s/rad", 0.0, 1e4, "drag torque per wheel speed", typical=0.1),
    ),
    needs=("two_inertia", "three_inertia"),
    # brakes the vehicle and takes as much from the wheel in its place: together it acts on the wheel alone
    law=Law(load=_brakes, tyre=_brakes),
)
