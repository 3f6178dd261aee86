"""A hysteretic (elastic, then slipping) path beside the shafts."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="shaft_hysteresis",
    title="Shaft hysteresis",
    stage=Stage.SHAFT,
    summary="A hysteretic (elastic, then slipping) path beside the shafts.",
    signature="More stiffness and less damping at small amplitude than at large.",
    shown_by="Chirps at two amplitudes; a slow triangle shows the loop.",
    parameters=(
        Parameter("stiffness_nm_rad", "N m/rad", 0.0, 1e6, "stiffness of the path while it sticks"),
        Parameter("slip_rad", "rad", 1e-9, 1.0, "twist at which it slips"),
    ),
    needs=("two_inertia", "three_inertia"),
)
