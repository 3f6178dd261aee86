"""Thresholds of the data: what is refused, what is noise, what is a gap."""

from __future__ import annotations

from typing import Annotated

from hil.analysis import stretches
from hil.analysis.diagnosis.threshold import Means

CLIPPED_SHARE: Annotated[
    float, Means("share of samples", "from this share at its end on a channel may be clipped", "bad_input")
] = 0.03
FEW_LEVELS: Annotated[
    int, Means("levels", "a channel with fewer tells neither a ratio nor a plateau", "bad_input")
] = 24
PLATEAU_SAMPLES: Annotated[
    int,
    Means("samples", "a shorter plateau is no clip; how far around one readings are looked at", "bad_input"),
] = 20
FROZEN_SAMPLES: Annotated[
    int, Means("samples", "a noisy channel that reads the same for longer is frozen", "bad_input")
] = 200
STEEP: Annotated[
    float,
    Means("steps of the reading", "a plateau is a clip where readings arrive and leave by more", "bad_input"),
] = 5.0
ROUNDED: Annotated[
    float,
    Means(
        "of the noise",
        "a coarser grid has plateaus of its own (rounding itself makes the noise larger)",
        "bad_input",
    ),
] = 0.2
TORQUE_MOVES: Annotated[
    float, Means("of its range", "torque that moves more should leave a mark in a plateau", "bad_input")
] = 0.1
MOVES_NOISE: Annotated[float, Means("noise levels", "a channel that does more moves", "bad_input")] = 5.0
FROZEN_STILL: Annotated[
    float,
    Means(
        "share of steps",
        "a channel that stands still more often elsewhere is rounded, not frozen",
        "bad_input",
    ),
] = 0.1
FROZEN_NOISY: Annotated[
    float,
    Means("share of steps", "that must turn back elsewhere for a channel to count as noisy", "bad_input"),
] = 0.3
FREEZE_WINDOWS_S: Annotated[
    tuple[float, float],
    Means("s", "a channel that holds a value for so long as others move on is frozen", "bad_input"),
] = (1.0, 4.0)
HOLDS_NOISE: Annotated[
    float, Means("noise levels", "a channel that does less holds a value", "bad_input")
] = 2.0
HOLDS_SHARE: Annotated[
    float, Means("of what a channel does in all", "a channel that does less holds a value", "bad_input")
] = 1e-3
PLAY_RAD: Annotated[
    float,
    Means("rad rms, wheel side", "and the twist: a speed that turns less may be held", "bad_input"),
] = 0.08
TURNS_ON: Annotated[
    float, Means("of what a channel does in all", "torque and speed that do more move on", "bad_input")
] = 0.3
BELOW_STEPS: Annotated[
    float, Means("steps of the grid", "a speed that moves by less may stand still as rounded", "bad_input")
] = 3.0
SPEEDS_UP: Annotated[
    float, Means("of the largest speed", "a slow speed that rises by more speeds up", "bad_input")
] = 0.05

SLOW_UNPROVEN: Annotated[
    float, Means("of the proven noise", "an error up to it may be called noise that is slow", "held_out")
] = 1.2


STANDSTILL_SHARE: Annotated[
    float, Means("of the largest speed", "below it the axle is near standstill", "gap")
] = 0.03
REVERSAL_S: Annotated[
    float, Means("s", "so long after torque changes its sign counts as reversal", "gap")
] = 0.15
LARGE_TORQUE: Annotated[float, Means("of the largest torque", "above it torque is large", "gap")] = 0.6
HIGH_SPEED: Annotated[float, Means("of the largest speed", "above it speed is high", "gap")] = 0.6

INVERTED: Annotated[float, Means("correlation", "below it a channel is inverted", "bad_input")] = -0.5
RELATED: Annotated[
    float, Means("correlation", "below it two channels have nothing to do with each other", "bad_input")
] = 0.5
SPEED_RATIO: Annotated[
    tuple[float, float],
    Means(
        "motor over wheel speed, over the gear ratio",
        "outside is beyond any error of a parameter or gain",
        "bad_input",
    ),
] = (0.62, 1.6)
APART_RAD: Annotated[
    float, Means("rad, wheel side", "smaller turns are lost in play and twist", "bad_input")
] = 0.2
DRIFT_S: Annotated[
    float, Means("s", "period from which on a swing of a speed may be drift of its channel", "sanity")
] = 25.0
IN_PROPORTION: Annotated[
    float, Means("correlation", "from it on motion as slow as a drift tells a sign or a ratio", "sanity")
] = 0.9
TURNED_RAD: Annotated[float, Means("rad rms, wheel side", "a ratio needs larger turns", "bad_input")] = 0.6
FAST_RAD_S: Annotated[
    float, Means("rad/s, wheel side", "several times any offset: mean speeds above are compared", "bad_input")
] = 5.0
SLOW_S: Annotated[float, Means("s", "torques are compared in means over so long", "bad_input")] = 0.5
PUSHED_RAD: Annotated[
    tuple[float, float],
    Means(
        "rad rms, wheel side",
        "of motor and wheel: the torque must push further (play lies between)",
        "bad_input",
    ),
] = (0.06, 0.02)
AGAINST: Annotated[
    float, Means("correlation", "below it a speed goes against what the torque does", "bad_input")
] = -0.6
LIKE: Annotated[
    tuple[float, float],
    Means("factor", "only turns of about the size that the torque gives tell a sign", "bad_input"),
] = (0.5, 2.0)
TOO_FAST: Annotated[float, Means("factor", "a speed changes too fast for the torque", "bad_input")] = 4.0
TORQUE_OFF: Annotated[
    float,
    Means(
        "factor", "shaft torque further from motor torque times gear ratio is in another unit", "bad_input"
    ),
] = 3.0
MOVES: Annotated[float, Means("noise levels", "a channel that does more moves", "bad_input")] = 5.0
NOISE_ALONE: Annotated[
    float, Means("noise levels", "a channel that does less reads noise alone", "bad_input")
] = 1.3
DEAD_SHARE: Annotated[
    float, Means("of what the other channel says", "below it a speed may be dead", "bad_input")
] = 0.05
LIKE_RPM: Annotated[
    float, Means("relative", "a factor this near to that between rpm and rad/s is named so", "bad_input")
] = 0.1
UNLIKE: Annotated[
    float,
    Means(
        "0 alike, 1 unrelated, 2 opposite",
        "a channel further from what the model says may be in another unit, turned or swapped",
        "bad_input",
    ),
] = 0.6
ALIKE: Annotated[
    float, Means("of the same", "all channels nearer once a mistake is undone: it was one", "bad_input")
] = 0.25
MISTAKE_BANDS_HZ: Annotated[
    tuple[float, ...], Means("Hz", "edges of the bands in which a mistake is looked for", "bad_input")
] = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0)
MISTAKE_TREND: Annotated[
    int,
    Means(
        "degree", "of what is left aside then: initial speeds, and what loads the axle evenly", "bad_input"
    ),
] = 2
LEAST_BANDS: Annotated[int, Means("octaves", "that a wrong sign must show in", "bad_input")] = 2
BAND_SHARE: Annotated[float, Means("of a channel's power", "a band with less says nothing", "bad_input")] = (
    0.003
)
SLOW_HZ: Annotated[
    float,
    Means("Hz", "of functions: below every resonance, and fast enough for drag to matter little", "sanity"),
] = 0.1
SHOWS: Annotated[float, Means("times the noise's power", "a band with less says nothing", "bad_input")] = 10.0

LEAST_SAMPLES: Annotated[int, Means("samples", "a recording with fewer is refused", "bad_input")] = (
    stretches.LEAST_SAMPLES
)
LEAST_DURATION_S: Annotated[
    float,
    Means(
        "s", "a shorter recording is refused: fewer than some tens of block means say nothing", "bad_input"
    ),
] = stretches.LEAST_DURATION_S
FIRST_STAMPS: Annotated[
    int, Means("samples", "a straight line through the stamps begins with these", "trace")
] = 50
UNEVEN_SHARE: Annotated[float, Means("of a sample", "stamps further off an even grid are noted", "trace")] = (
    0.01
)
NEAR_SHARE: Annotated[
    float, Means("of a sample", "a reading this near to a point of the grid stands for it", "trace")
] = 0.5
FIT_RATE_HZ: Annotated[
    float, Means("Hz", "rate of block means: driveline modes end below 60 Hz", "trace")
] = 250.0
START_SAMPLES: Annotated[
    int, Means("samples", "at most so many are the reading before the torque does anything", "trace")
] = 20
LITTLE_TORQUE: Annotated[
    float, Means("of the largest", "torque below it is none: a fed back torque is never quite zero", "trace")
] = 0.01
GAP_SAMPLES: Annotated[float, Means("samples", "a longer pause is a gap", "bad_input")] = (
    stretches.GAP_SAMPLES
)
SLOWEST_SAMPLE_S: Annotated[float, Means("s", "a recording sampled more slowly is refused", "bad_input")] = (
    0.02
)
WORSE: Annotated[
    float, Means("times the error before", "a band of a channel with more was made worse", "gap")
] = 1.5
WORSE_NOISES: Annotated[
    float, Means("error over noise", "and with less than this no one would see it", "gap")
] = 3.0
