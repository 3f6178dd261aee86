"""Dry friction on the rotor side, with an optional Stribeck peak and asymmetry."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="coulomb_friction",
    title="Coulomb friction",
    stage=Stage.ROTOR,
    summary="Dry friction on the rotor side, with an optional Stribeck peak and asymmetry.",
    signature="A constant torque against the motion; at standstill small torques move nothing.",
    shown_by="Speed reversals: an axle that always turns one way hides it.",
    parameters=(
        Parameter("torque_nm", "N m", 0.0, 1e4, "friction torque"),
        Parameter("stribeck_torque_nm", "N m", 0.0, 1e4, "added near standstill", optional=True, default=0.0),
        Parameter(
            "offset_nm",
            "N m",
            -1e4,
            1e4,
            "asymmetry: friction that is the same in both directions of turning",
            optional=True,
            default=0.0,
        ),
    ),
)
