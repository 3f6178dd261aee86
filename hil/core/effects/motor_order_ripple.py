"""Torque ripple at a multiple of rotor angle (cogging, imbalance, eccentricity)."""

from hil.core.effects._effect import Effect, Parameter, Stage

EFFECT = Effect(
    id="motor_order_ripple",
    title="Motor order ripple",
    stage=Stage.ROTOR,
    summary="Torque ripple at a multiple of rotor angle (cogging, imbalance, eccentricity).",
    signature="A line whose frequency follows motor speed, also at constant torque.",
    shown_by="Hold or sweep speed at constant torque.",
    parameters=(
        Parameter("order", "1/rev", 0.01, 1000.0, "ripple periods per rotor turn"),
        Parameter("amplitude_nm", "N m", 0.0, 1e5, "amplitude of the ripple, rotor side"),
        Parameter("phase_rad", "rad", -6.2832, 6.2832, "phase at rotor angle zero"),
    ),
)
