"""Constant plus speed-squared load on the vehicle inertia."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="running_resistance",
    title="Running resistance",
    stage=Stage.LOAD,
    summary="Constant plus speed-squared load on the vehicle inertia.",
    signature="Speed reached falls short, more at high speed; nothing at resonance.",
    shown_by="Coast-down from a high speed.",
    parameters=(
        Parameter("rolling_nm", "N m", 0.0, 1e5, "constant part, against the motion"),
        Parameter("aero_nms2_rad2", "N m s²/rad²", 0.0, 1e4, "part proportional to speed squared"),
    ),
)
