"""A hysteretic path beside the shafts, elastic and then slipping: dz/dt = v·(1 - (z/s)²) while it is loaded.

v is the rate of twist, s the twist at which the path slips; unloading is elastic. Over a step at constant v
that equation has the solution tanh, so no step is too long for it (Bouc-Wen's model with n = 2, β = γ).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Memory, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, scaled
from hil.core.effects._smooth import tanh_over


def _shaft(motion: Motion, chain: Chain, slip: float, values: Values) -> float:
    return values[0] * slip


def _remember(before: Motion, after: Motion, chain: Chain, slip: float, values: Values, h: float) -> float:
    v = 0.5 * (before.twist_rate + after.twist_rate)
    largest = values[1]
    inverse = 1.0 / largest
    ratio = slip * inverse
    if ratio * v <= 0.0:
        slip += h * v
    else:
        above, below = tanh_over(h * v * inverse)  # (ratio + tanh) / (1 + ratio·tanh) by one division
        slip = largest * (ratio * below + above) / (below + ratio * above)
    return min(max(slip, -largest), largest)


def _steps(chain: Chain, values: Values, dt: float) -> int:
    return 2


def _probes(scene: Scene) -> Iterator[Probe]:
    stiffness = scene.parameters["shaft_stiffness"]
    twist = scene.shaft_torque_nm / stiffness
    for share in (0.005, 0.02, 0.06, 0.15, 0.35, 0.7):
        yield scaled("stiffness_nm_rad", 0.08 * stiffness, 0.0, 8.0, slip_rad=share * twist)


_CYCLE = 4.0  # slip twists to either side
_SAMPLES = 2000


def _derived(values: Mapping[str, float]) -> dict[str, float]:
    """Energy lost in one cycle: its numbers differ from formula to formula, the area of its loop does not."""
    largest = values["slip_rad"]
    path, area = -largest, 0.0
    step = 2.0 * _CYCLE * largest / _SAMPLES
    for _ in range(_SAMPLES):
        rise = 1.0 if path < 0.0 else 1.0 - (path / largest) ** 2
        moved = min(path + rise * step, largest)
        area += 0.5 * (path + moved) * step
        path = moved
    return {"loop_area_j": 2.0 * values["stiffness_nm_rad"] * area}


EFFECT = Effect(
    id="shaft_hysteresis",
    title="Shaft hysteresis",
    stage=Stage.SHAFT,
    summary="A hysteretic (elastic, then slipping) path beside the shafts.",
    signature="More stiffness and less damping at small amplitude than at large.",
    shown_by="Chirps at two amplitudes; a slow triangle shows the loop.",
    source="R. Bouc, 1967; Y. K. Wen, J. Engineering Mechanics Division 102 (1976)",
    parameters=(
        Parameter("stiffness_nm_rad", "N m/rad", 0.0, 1e6, "stiffness of the path while it sticks"),
        Parameter("slip_rad", "rad", 1e-9, 1.0, "twist at which it slips", within=(1e-9, 0.1)),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(shaft=_shaft, remember=_remember, steps=_steps),
    memory=Memory("rad", "twist of the hysteretic path"),
    probes=_probes,
    similar=("coulomb_friction",),
    derived=_derived,
)
