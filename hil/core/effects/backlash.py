"""Free play in series with elastic, damped shafts: the exact model of a gap, with the flanks' own damping.

The gap's own position, the seat, is the memory. In contact it stands at one end of the gap and the shafts
carry k·e + (c + d)·de/dt of one sign; once that would pull, contact is lost and the shafts, free, relax with
the time constant c / k until the seat has moved to an end again. A vanishing gap leaves the shaft itself,
which a vanishing dead zone of the twist does not (Nordin, Galic and Gutman, Int. J. Adaptive Control and
Signal Processing 11, 1997). Flanks that lose energy in a blow have a damping d of their own while they
touch; a coefficient of restitution e stands for the d with which rotor and wheel, meeting on the shafts'
stiffness k with a reduced inertia m, part at e times the speed at which they met:
e = exp(-2·ζ/√(1 - ζ²)·atan(√(1 - ζ²)/ζ)), d = 2·ζ·√(k·m), for flanks that let go once they would pull
(for ζ above 1, e below 0.135: √(ζ² - 1) and atanh). Damping strikes with the speed of approach: flanks that
give back little strike hard. Below 0.1 nothing is told apart; what is given there acts as 0.1. With both a
damping and a restitution, the two dampings add.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from hil.core.chain import TWO_INERTIA, Chain
from hil.core.effects._effect import Effect, Memory, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, sized

_SEATED_NM = 2.0  # a first shaft torque that surely is in contact
_HALVINGS = 60
_CRITICAL = 1e-6
_LEAST_RESTITUTION = 0.1


def parting_share(ratio: float) -> float:
    """Speed of parting over speed of meeting, of a spring that cannot pull with a damping ratio `ratio`."""
    root = math.sqrt(abs(1.0 - ratio * ratio))
    if root < _CRITICAL:
        return math.exp(-2.0)
    turned = math.atan2(root, ratio) if ratio < 1.0 else math.atanh(root / ratio)
    return math.exp(-2.0 * ratio / root * turned)


def damping_of(restitution: float, chain: Chain) -> float:
    """Damping in N m s/rad, wheel side, of flanks of a coefficient of restitution."""
    rotor = chain.motor_inertia * chain.gear_ratio * chain.gear_ratio
    wheel = chain.vehicle_inertia if chain.kind == TWO_INERTIA else chain.wheel_inertia
    reduced = rotor * wheel / (rotor + wheel)
    restitution = max(restitution, _LEAST_RESTITUTION)
    low, high = 1e-9, 1e3
    for _ in range(_HALVINGS):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if parting_share(middle) > restitution else (low, middle)
    return 2.0 * low * math.sqrt(chain.shaft_stiffness * reduced)


def _prepare(chain: Chain, values: Values) -> Values:
    half_gap, contact_damping, restitution = values
    if restitution < 1.0:
        contact_damping += damping_of(restitution, chain)
    return half_gap, contact_damping, 1.0


def _shaft(motion: Motion, chain: Chain, seat: float, values: Values) -> float:
    """What contact and gap take from or add to the torque of shafts without play."""
    half_gap = values[0]
    linear = chain.shaft_stiffness * motion.twist + chain.shaft_damping * motion.twist_rate
    if -half_gap < seat < half_gap:
        return -linear
    damping = chain.shaft_damping + values[1]
    torque = chain.shaft_stiffness * (motion.twist - seat) + damping * motion.twist_rate
    return (max(0.0, torque) if seat > 0.0 else min(0.0, torque)) - linear


def _stretch(twist: float, chain: Chain, seat: float, values: Values) -> float:
    return twist - seat if abs(seat) >= values[0] else 0.0


def _remember(before: Motion, after: Motion, chain: Chain, seat: float, values: Values, h: float) -> float:
    kept = 0.0
    if chain.shaft_damping > 0.0:
        kept = math.exp(-h * chain.shaft_stiffness / chain.shaft_damping)
    return min(max(after.twist - kept * (before.twist - seat), -values[0]), values[0])


def _begin(torque: float, chain: Chain, values: Values) -> float:
    """A small torque may lie anywhere in the gap: let it come smoothly to one side."""
    return values[0] * min(max(torque / _SEATED_NM, -1.0), 1.0)


def _steps(chain: Chain, values: Values, dt: float) -> int:
    return 2


def _probes(scene: Scene) -> Iterator[Probe]:
    for step in range(12):
        yield sized("half_gap_rad", 2e-4 * 600.0 ** (step / 11), 0.2, restitution=1.0)


def _derived(values: Mapping[str, float]) -> dict[str, float]:
    return {"lost_motion_deg": math.degrees(2.0 * values["half_gap_rad"])}


EFFECT = Effect(
    id="backlash",
    title="Backlash",
    stage=Stage.SHAFT,
    summary="Free play between gear output and shafts, wheel side.",
    signature="Shaft torque stays at zero for a while after each torque reversal, then a blow.",
    shown_by="Torque reversals at small and large amplitude, and a biased chirp that never reverses.",
    source="Nordin, Galic and Gutman, Int. J. Adaptive Control and Signal Processing 11 (1997)",
    parameters=(
        Parameter("half_gap_rad", "rad", 0.0, 0.5, "half of the free play", step=30.0, rough=True),
        Parameter(
            "contact_damping_nms_rad",
            "N m s/rad",
            0.0,
            1e5,
            "of the flanks while they touch, wheel side",
            optional=True,
            typical=10.0,
            opens=(10.0, 50.0),
        ),
        Parameter(
            "restitution",
            "1",
            0.0,
            1.0,
            "share of the speed of approach that a blow gives back: another way to give a damping; both add",
            optional=True,
            default=1.0,
            fitted=False,
        ),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(prepare=_prepare, shaft=_shaft, stretch=_stretch, remember=_remember, begin=_begin, steps=_steps),
    memory=Memory("rad", "where the shafts stand in the gap"),
    probes=_probes,
    abrupt=True,
    many_laws=True,
    derived=_derived,
)
