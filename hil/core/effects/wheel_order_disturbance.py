"""Shaft torque ripple at a multiple of wheel angle (tripod joints, tyre non-uniformity)."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, ripple
from hil.core.effects._smooth import sine


def _shaft(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    order, amplitude, phase = values
    return amplitude * sine(order * motion.wheel_angle + phase)


def _probes(scene: Scene) -> Iterator[Probe]:
    for order in scene.orders("wheel"):
        yield ripple(order, 0.5)


EFFECT = Effect(
    id="wheel_order_disturbance",
    title="Wheel order disturbance",
    stage=Stage.SHAFT,
    summary="Shaft torque ripple at a multiple of wheel angle (tripod joints, tyre non-uniformity).",
    signature="A line whose frequency follows wheel speed, also at constant torque.",
    shown_by="Hold or sweep speed at constant torque.",
    parameters=(
        Parameter("order", "1/rev", 0.01, 1000.0, "ripple periods per wheel turn", typical=0.01, step=1e-3),
        Parameter("amplitude_nm", "N m", 0.0, 1e5, "amplitude of the ripple, wheel side"),
        Parameter(
            "phase_rad",
            "rad",
            -6.2832,
            6.2832,
            "phase at wheel angle zero",
            typical=0.1,
            within=(-50.0, 50.0),
        ),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(shaft=_shaft, follows="wheel"),
    sizes=("amplitude_nm",),
    probes=_probes,
)
