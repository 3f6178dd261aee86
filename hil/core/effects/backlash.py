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
give back little strike hard. Below 0.1 nothing is distinguished; what is given there acts as 0.1. With both a
damping and a restitution, the two dampings add.

A damping that strikes from nothing is an idealisation. With `contact_depth_rad` that of the flanks counts
from where they meet with shafts untwisted, however wound these still are, and sets in over that depth beyond
it, in a cubic step (as in the IMPACT function of MSC Adams); with 0 it acts as soon and as long as flanks
touch. With `one_spring` 1 that of the shafts sets in alike, and free they are untwisted at once: a dead zone
of the twist, which never pulls. With `film` 1 their damping acts in the gap as well: a dead zone of the
spring alone.

Other authors' flanks stand beside it. With `tension` 1 they bear all the pull of the dampings, as an oil film
does until they part, and shafts that are free are untwisted at once: contact is where the twist is beyond the
gap, k·δ + (c + d)·δ' (Kelvin and Voigt). `depth_damping_nms_rad2` λ adds λ·δ·δ' to the spring, which alone
never pulls (K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42, 1975). Between 0 and 1 tension mixes both.
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
_STEP_S = 1e-3  # of fits: an axle's shafts swing in 30 and more
_SIZES = 12  # of gaps that a diagnosis tries first, by each of these laws
_LAWS: tuple[dict[str, float], ...] = ({}, {"one_spring": 1.0}, {"film": 1.0})


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
    """What the laws below get, so that they need not ask, which takes longer.

    In place of the restitution stands the least share of a damping that flanks have as they touch, of the
    depth its inverse in 1/rad, of one spring the shafts' own damping that is not whole at once, in N m s/rad.
    """
    half_gap, contact_damping, restitution, depth_damping, tension, depth, one_spring, film = values
    if restitution < 1.0:
        contact_damping += damping_of(restitution, chain)
    at_once, inverse = (0.0, 1.0 / depth) if depth > 0.0 else (1.0, 0.0)
    film *= chain.shaft_damping
    later = one_spring * (chain.shaft_damping - film)
    return half_gap, contact_damping, at_once, depth_damping, tension, inverse, later, film


def _shaft(motion: Motion, chain: Chain, seat: float, values: Values) -> float:
    """What contact and gap take from or add to the torque of shafts without play."""
    linear = chain.shaft_stiffness * motion.twist + chain.shaft_damping * motion.twist_rate
    return _contact(motion, chain, seat, values) + values[7] * motion.twist_rate - linear


def _contact(motion: Motion, chain: Chain, seat: float, values: Values) -> float:
    """Torque of the shafts in N m, with free play, but for what goes through a film in it."""
    if -values[0] < seat < values[0]:
        return 0.0
    return _torque(motion.twist, motion.twist_rate, chain, seat, values)


def _torque(twist: float, rate: float, chain: Chain, seat: float, values: Values) -> float:
    """The same while flanks touch."""
    tension = values[4]
    damping = _damping(twist, chain, seat, values) * rate
    spring = chain.shaft_stiffness * (twist - seat) + values[3] * abs(twist - seat) * rate
    free, held = spring + damping, spring
    if seat > 0.0:
        free, held = max(0.0, free), max(0.0, held)
    else:
        free, held = min(0.0, free), min(0.0, held)
    return (1.0 - tension) * free + tension * (held + damping)


def _damping(twist: float, chain: Chain, seat: float, values: Values) -> float:
    """Damping in N m s/rad of shafts and flanks that touch."""
    pressed = math.copysign(1.0, seat) * twist - values[0]
    share = min(max(pressed * values[5], values[2]), 1.0)
    not_yet = 1.0 - share * share * (3.0 - 2.0 * share)
    return chain.shaft_damping - values[7] + values[1] - not_yet * (values[1] + values[6])


def _leap(
    before: Motion, after: Motion, chain: Chain, seat: float, values: Values, h: float
) -> tuple[float, float]:
    """What flanks that meet or part within a step do beyond a torque that goes straight from end to end.

    Torque leaps as they meet, and as flanks that pull part. The result has the mean and the first moment
    over the step of a torque that goes straight only while flanks touch.
    """
    half_gap = values[0]
    free = _unbounded(before, after, chain, seat, values, h)
    first, last = _touching(seat, half_gap), _touching(free, half_gap)
    if first == last:
        return 0.0, 0.0
    begins, rises, parted = 0.0, 0.0, 0.0
    if first != 0.0:
        torque = _torque(before.twist, before.twist_rate, chain, seat, values)
        parted = _parted(before, after, chain, seat, values)
        at_end = _torque_at(parted, before, after, chain, seat, values)
        mean, moment = 0.5 * parted * (torque + at_end), parted * parted * (torque + 2.0 * at_end) / 6.0
        begins += 4.0 * mean - 6.0 * moment - torque
        rises += 12.0 * moment - 6.0 * mean + torque
    if last != 0.0:
        flank = last * half_gap
        met = parted + (1.0 - parted) * (flank - seat) / (free - seat)
        at_start = _torque_at(met, before, after, chain, flank, values)
        torque = _torque(after.twist, after.twist_rate, chain, flank, values)
        mean = 0.5 * (1.0 - met) * (at_start + torque)
        moment = (1.0 - met) * ((2.0 * met + 1.0) * at_start + (met + 2.0) * torque) / 6.0
        begins += 4.0 * mean - 6.0 * moment
        rises += 12.0 * moment - 6.0 * mean - torque
    return begins, rises


def _touching(seat: float, half_gap: float) -> float:
    """Which flank the seat is at: 1, -1, or 0 for none."""
    return 1.0 if seat >= half_gap else -1.0 if seat <= -half_gap else 0.0


def _parted(before: Motion, after: Motion, chain: Chain, seat: float, values: Values) -> float:
    """Share of a step after which flanks part: where spring and dampings, less what they may pull, are 0."""
    ends = _unpulled(after, chain, seat, values)
    if ends == 0.0 or (ends > 0.0) == (seat >= 0.0):
        return 1.0
    begins = _unpulled(before, chain, seat, values)
    return begins / (begins - ends) if begins != 0.0 and (begins > 0.0) == (seat >= 0.0) else 0.0


def _unpulled(motion: Motion, chain: Chain, seat: float, values: Values) -> float:
    """Spring and dampings, less what these may pull, in N m."""
    damping = (1.0 - values[4]) * _damping(motion.twist, chain, seat, values)
    return chain.shaft_stiffness * (motion.twist - seat) + damping * motion.twist_rate


def _torque_at(
    share: float, before: Motion, after: Motion, chain: Chain, seat: float, values: Values
) -> float:
    """Torque after a share of a step in which flanks touch."""
    twist = _between(before.twist, after.twist, share)
    return _torque(twist, _between(before.twist_rate, after.twist_rate, share), chain, seat, values)


def _between(begins: float, ends: float, share: float) -> float:
    return begins + share * (ends - begins)


def _kept(chain: Chain, values: Values, h: float) -> float:
    """Share of a twist that shafts within the gap still have after `h` seconds."""
    relaxing = (1.0 - values[4]) * (chain.shaft_damping - values[7] - values[6])
    return math.exp(-h * chain.shaft_stiffness / relaxing) if relaxing > 0.0 else 0.0


def _stretch(twist: float, chain: Chain, seat: float, values: Values) -> float:
    return twist - seat if abs(seat) >= values[0] else 0.0


def _unbounded(before: Motion, after: Motion, chain: Chain, seat: float, values: Values, h: float) -> float:
    """Where the seat would be after a step if the gap had no end on the other side."""
    if -values[0] < seat < values[0]:
        return after.twist - _kept(chain, values, h) * (before.twist - seat)
    parted = _parted(before, after, chain, seat, values)
    if parted == 1.0:
        return seat
    stretch = _between(before.twist, after.twist, parted) - seat
    return after.twist - _kept(chain, values, (1.0 - parted) * h) * stretch


def _remember(before: Motion, after: Motion, chain: Chain, seat: float, values: Values, h: float) -> float:
    return min(max(_unbounded(before, after, chain, seat, values, h), -values[0]), values[0])


def _begin(torque: float, chain: Chain, values: Values) -> float:
    """A small torque may lie anywhere in the gap: let it come smoothly to one side."""
    return values[0] * min(max(torque / _SEATED_NM, -1.0), 1.0)


def _steps(chain: Chain, values: Values, dt: float) -> int:
    return max(1, round(dt / _STEP_S))


def _probes(scene: Scene) -> Iterator[Probe]:
    for step in range(_SIZES):
        gap = 2e-4 * 600.0 ** (step / (_SIZES - 1))
        for law in _LAWS:
            probe = sized("half_gap_rad", gap, 0.2, restitution=1.0, tension=0.0, **law)
            yield probe.at(step, first=step % 2 == 0)


def _derived(values: Mapping[str, float]) -> dict[str, float]:
    return {"lost_motion_deg": math.degrees(2.0 * values["half_gap_rad"])}


EFFECT = Effect(
    id="backlash",
    title="Backlash",
    stage=Stage.SHAFT,
    summary="Free play between gear output and shafts, wheel side.",
    signature="Shaft torque stays at zero for a while after each torque reversal, then an impact.",
    shown_by="Torque reversals at small and large amplitude, and a biased chirp that never reverses.",
    source="Nordin, Galic and Gutman, Int. J. Adaptive Control and Signal Processing 11 (1997); "
    "Hunt and Crossley, J. Appl. Mech. 42 (1975)",
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
            opens=(2.0, 10.0, 50.0),
        ),
        Parameter(
            "restitution",
            "1",
            0.0,
            1.0,
            "coefficient of restitution of an impact: another way to give a damping; both add",
            optional=True,
            default=1.0,
            fitted=False,
        ),
        Parameter(
            "depth_damping_nms_rad2",
            "N m s/rad²",
            0.0,
            1e6,
            "of the flanks for each rad of compression, by Hunt and Crossley",
            optional=True,
            typical=20.0,
        ),
        Parameter(
            "tension",
            "1",
            0.0,
            1.0,
            "share of the dampings' pull that flanks bear until they part: 0 none, 1 all (Kelvin, Voigt)",
            optional=True,
            fitted=False,
            choices=(0.0, 1.0),
        ),
        Parameter(
            "contact_depth_rad",
            "rad",
            0.0,
            0.1,
            "beyond where flanks meet untwisted, until their contact damping is whole; 0: at any touch",
            optional=True,
            typical=1e-3,
            within=(1e-5, 0.1),
            opens=(5e-4, 2e-3),
            beside=("contact_damping_nms_rad", "one_spring"),
        ),
        Parameter(
            "one_spring",
            "1",
            0.0,
            1.0,
            "share of the shafts' own damping that sets in alike; free, they are untwisted at once",
            optional=True,
            fitted=False,
            choices=(0.0, 1.0),
        ),
        Parameter(
            "film",
            "1",
            0.0,
            1.0,
            "share of the shafts' own damping that acts through the gap as well, as that of oil does",
            optional=True,
            fitted=False,
            choices=(0.0, 1.0),
        ),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(
        prepare=_prepare,
        shaft=_shaft,
        leap=_leap,
        stretch=_stretch,
        remember=_remember,
        begin=_begin,
        steps=_steps,
    ),
    memory=Memory("rad", "where the shafts stand in the gap"),
    probes=_probes,
    abrupt=True,
    derived=_derived,
)
