"""Drag proportional to rotor speed."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="viscous_drag",
    title="Viscous drag",
    stage=Stage.ROTOR,
    summary="Drag proportional to rotor speed.",
    signature="Speed reached falls short, in proportion to speed.",
    shown_by="A long step or coast-down over a wide speed range.",
    parameters=(Parameter("coefficient_nms_rad", "N m s/rad", 0.0, 100.0, "drag torque per rotor speed"),),
)
