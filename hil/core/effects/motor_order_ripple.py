"""Torque ripple at a multiple of rotor angle (cogging, imbalance, eccentricity)."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, ripple
from hil.core.effects._smooth import sine


def _loss(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    order, amplitude, phase = values
    return -amplitude * sine(order * motion.rotor_angle + phase)


def _probes(scene: Scene) -> Iterator[Probe]:
    for order in scene.orders("rotor"):
        yield ripple(order, 0.05)


EFFECT = Effect(
    id="motor_order_ripple",
    title="Motor order ripple",
    stage=Stage.ROTOR,
    summary="Torque ripple at a multiple of rotor angle (cogging, imbalance, eccentricity).",
    signature="A line whose frequency follows motor speed, also at constant torque.",
    shown_by="Hold or sweep speed at constant torque.",
    parameters=(
        Parameter("order", "1/rev", 0.01, 1000.0, "ripple periods per rotor turn", typical=0.01, step=1e-3),
        Parameter("amplitude_nm", "N m", 0.0, 1e5, "amplitude of the ripple, rotor side"),
        Parameter(
            "phase_rad",
            "rad",
            -6.2832,
            6.2832,
            "phase at rotor angle zero",
            typical=0.1,
            within=(-50.0, 50.0),
        ),
    ),
    law=Law(loss=_loss, follows="rotor"),
    sizes=("amplitude_nm",),
    probes=_probes,
)
