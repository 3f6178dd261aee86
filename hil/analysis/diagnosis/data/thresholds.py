"""Thresholds of the data: what is refused, what is noise, what is a gap."""

from __future__ import annotations

from typing import Annotated

from hil.analysis.diagnosis.threshold import Means

LIKELIER: Annotated[float, Means("times likelier", "a mistake than none is refused", "bad_input")] = 1e3
ALIKE: Annotated[
    float,
    Means("0 alike, 1 unrelated, 2 opposite", "how unlike what belongs together is on average", "bad_input"),
] = 0.1
ALIKE_SPEEDS: Annotated[
    float, Means("of the same", "where a model says that both speeds go together", "bad_input")
] = 0.02
TREND: Annotated[
    int, Means("degree", "of what is left aside: initial speeds, what loads the axle evenly", "bad_input")
] = 2
SLOW_S: Annotated[float, Means("s", "means over so long: a rotor may rattle in play", "bad_input")] = 0.25
ANYTHING: Annotated[
    float,
    Means("probability", "that in an octave nothing goes together, though nothing is mistaken", "bad_input"),
] = 0.25
FREE_SIZE: Annotated[float, Means("log", "by which sizes by model and as recorded differ", "bad_input")] = 0.5
GEAR_SIZE: Annotated[
    float, Means("log", "by which the ratio of speeds differs from the model's", "bad_input")
] = 0.12
ANY_SIZE: Annotated[float, Means("log", "by which sizes in another unit differ", "bad_input")] = 3.0
SHOWS: Annotated[float, Means("times the noise's power", "an octave with less says nothing", "bad_input")] = (
    10.0
)
PLAY_RAD: Annotated[
    float, Means("rad rms, wheel side", "and the twist: a speed that turns less may be held", "bad_input")
] = 0.08
MOVES: Annotated[float, Means("noise levels", "a channel that does more moves", "bad_input")] = 1.5
SPEEDS_UP: Annotated[
    float, Means("of the largest speed", "a slow speed that rises by more speeds up", "bad_input")
] = 0.05
PLATEAU_SAMPLES: Annotated[
    int,
    Means("samples", "a shorter plateau is no clip; how far around one readings are looked at", "bad_input"),
] = 20
STEEP: Annotated[
    float,
    Means("steps of the reading", "a plateau is a clip where readings arrive and leave by more", "bad_input"),
] = 5.0
TORQUE_MOVES: Annotated[
    float, Means("of its range", "torque that moves more should leave a mark in a plateau", "bad_input")
] = 0.1
FROZEN_S: Annotated[
    float, Means("s", "noise that reads the same for less may be a lost telegram", "bad_input")
] = 0.2
FREEZE_WINDOWS_S: Annotated[
    tuple[float, float],
    Means("s", "a channel that holds a value for so long as others move on is frozen", "bad_input"),
] = (1.0, 4.0)
HOLDS_SHARE: Annotated[
    float, Means("of what a channel does in all", "a channel that does less holds a value", "bad_input")
] = 1e-3
TURNS_ON: Annotated[
    float, Means("of what a channel does in all", "torque and speed that do more move on", "bad_input")
] = 0.3
HELD_STEPS: Annotated[
    float, Means("steps of the reading", "a speed that moves by less may read the same", "bad_input")
] = 3.0
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
WORSE: Annotated[
    float, Means("times the error before", "a band of a channel with more was made worse", "gap")
] = 1.5
WORSE_NOISES: Annotated[
    float, Means("error over noise", "and with less than this no one would see it", "gap")
] = 3.0
