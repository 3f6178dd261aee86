"""Free play between gear output and shafts, wheel side."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="backlash",
    title="Backlash",
    stage=Stage.SHAFT,
    summary="Free play between gear output and shafts, wheel side.",
    signature="Shaft torque stays at zero for a while after each torque reversal, then a blow.",
    shown_by="Torque reversals at small and large amplitude, and a biased chirp that never reverses.",
    parameters=(Parameter("half_gap_rad", "rad", 0.0, 0.5, "half of the free play"),),
    needs=("two_inertia", "three_inertia"),
)
