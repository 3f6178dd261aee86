"""Dry friction on the load side: on the wheel, or on the load where a model has no wheel of its own.

Coulomb's law against the motion of the wheel. Below 0.05 rad/s it fades, so it holds nothing at standstill;
what holds an axle at rest is `coulomb_friction`, rotor side.
"""

from __future__ import annotations

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._smooth import tanh

# Width of a smooth sign function: small against any speed of interest, large enough for steps of 0.1 ms.
_WIDTH_RAD_S = 0.05


def _brakes(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    torque, offset = values
    return torque * tanh(motion.wheel_speed / _WIDTH_RAD_S) + offset


EFFECT = Effect(
    id="load_coulomb_friction",
    title="Coulomb friction on the load",
    stage=Stage.LOAD,
    summary="Dry friction on the wheel (on the load, where the model has two inertias), wheel side.",
    signature="A constant torque against the wheel's motion that the shafts carry.",
    shown_by="Speed reversals with the shaft torque recorded.",
    needs=("two_inertia", "three_inertia"),
    needs_reversals=True,
    source="C. A. Coulomb (1785); H. Olsson et al., European Journal of Control 4 (1998) 176-195",
    parameters=(
        Parameter(
            "torque_nm",
            "N m",
            0.0,
            1e5,
            "friction torque, against the motion; below 0.05 rad/s it fades, and holds nothing at standstill",
            typical=1.0,
        ),
        Parameter(
            "offset_nm",
            "N m",
            -1e5,
            1e5,
            "asymmetry: friction that is the same in both directions of turning",
            optional=True,
            typical=1.0,
            opens=(0.0,),
        ),
    ),
    # brakes the vehicle and takes as much from the wheel in its place: together it acts on the wheel alone
    law=Law(load=_brakes, tyre=_brakes),
    sizes=("torque_nm", "offset_nm"),
)
