"""The tyre passes torque by slipping: its force follows slip over a relaxation length.

T' = (r/σ)·(C·(ω_l - ω_v) - |ω_v|·T), with slip stiffness C, relaxation length σ and wheel radius r; the
tyre's torque is T + D·(ω_l - ω_v). Written for a twist θ = T / k with k = C·r/σ that is a spring at rest:
θ' = ω_l - ω_v - (r/σ)·|ω_v|·θ: the faster the wheel, the more the spring relaxes (H. B. Pacejka, Tire and
Vehicle Dynamics, ch. 7: single contact point transient tyre model). ω_v in |ω_v| is the vehicle model's
speed, also where the dynamometer follows it late.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.chain import WHEEL_RADIUS_M, Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, fixed


def _spring(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain["tyre_stiffness"] = (
        values["slip_stiffness_nm"] * chain["wheel_radius_m"] / values["relaxation_length_m"]
    )


def _relaxed(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    return -abs(motion.vehicle_speed) * chain.wheel_radius_m / values[1] * motion.tyre_twist


def _probes(scene: Scene) -> Iterator[Probe]:
    for stiffness in (0.5, 1.0, 2.0):
        for length in (0.05, 0.15, 0.4, 1.2, 4.0):
            slip = stiffness * scene.parameters["tyre_stiffness"] * length / WHEEL_RADIUS_M
            yield fixed(slip_stiffness_nm=slip, relaxation_length_m=length)


EFFECT = Effect(
    id="tyre_slip",
    title="Tyre slip",
    stage=Stage.TYRE,
    summary=(
        "The tyre transmits torque by slip: force follows slip over a relaxation length, "
        "so its damping depends on speed. It takes the place of the tyre's stiffness."
    ),
    signature="The wheel's resonance is damped more the faster the axle turns; at rest it is a spring.",
    shown_by="A chirp at standstill and one at speed.",
    source="H. B. Pacejka, Tire and Vehicle Dynamics, ch. 7",
    parameters=(
        Parameter("slip_stiffness_nm", "N m", 1e-3, 1e9, "torque over slip, both wheels"),
        Parameter("relaxation_length_m", "m", 1e-3, 100.0, "relaxation length of torque after slip"),
    ),
    needs=("three_inertia",),
    law=Law(chain=_spring, tyre_rate=_relaxed),
    probes=_probes,
    similar=("dyno_lag",),
)
