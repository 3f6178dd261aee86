"""The shaft torque gains c·twist³."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="shaft_cubic_stiffness",
    title="Cubic shaft stiffness",
    stage=Stage.SHAFT,
    summary="The shaft torque gains c·twist³.",
    signature="The resonance moves up (or down) with amplitude and with bias torque.",
    shown_by="Chirps at two amplitudes or two bias torques.",
    parameters=(Parameter("coefficient_nm_rad3", "N m/rad³", -1e9, 1e9, "c in T_s = k·twist + c·twist³"),),
    needs=("two_inertia", "three_inertia"),
)
