"""Shaft torque ripple at a multiple of wheel angle (tripod joints, tyre non-uniformity)."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="wheel_order_disturbance",
    title="Wheel order disturbance",
    stage=Stage.SHAFT,
    summary="Shaft torque ripple at a multiple of wheel angle (tripod joints, tyre non-uniformity).",
    signature="A line whose frequency follows wheel speed, also at constant torque.",
    shown_by="Hold or sweep speed at constant torque.",
    parameters=(
        Parameter("order", "1/rev", 0.01, 1000.0, "ripple periods per wheel turn"),
        Parameter("amplitude_nm", "N m", 0.0, 1e5, "amplitude of the ripple, wheel side"),
        Parameter("phase_rad", "rad", -6.2832, 6.2832, "phase at wheel angle zero"),
    ),
    needs=("two_inertia", "three_inertia"),
)
