"""Thresholds of what is stated: verdict, confidence, words, separating tests."""

from __future__ import annotations

from typing import Annotated

from hil.analysis.diagnosis.threshold import Means

LEAST_TORQUE_NM: Annotated[
    float, Means("N m", "without more in the recordings no one knows what a test may ask", "separating")
] = 0.1
WORTH_A_PLAN: Annotated[float, Means("probability", "a less likely rival gets no plan", "separating")] = 0.02

STEP_NM: Annotated[float, Means("N m", "the step whose overshoot is stated", "consequences")] = 20.0
STEP_FROM_RAD_S: Annotated[float, Means("rad/s", "wheel speed from which it is made", "consequences")] = 5.0
LASTING: Annotated[
    float, Means("of its peak", "must last of the shaft torque for an overshoot to be stated", "consequences")
] = 0.1

DURATION_S: Annotated[float, Means("s", "of a separating test", "separating")] = 20.0
TELLS: Annotated[
    float, Means("noise levels, root of the sum of squares", "a test must tell two models by", "separating")
] = 10.0
NUMBERS_FREE: Annotated[
    float, Means("of a number", "by which a fit of the test's recording may change it", "separating")
] = 0.1
NUMBERS_STEP: Annotated[float, Means("of a number", "of the finite differences there", "separating")] = 1e-3
SETTLE_S: Annotated[float, Means("s", "a speed is held before it", "separating")] = 2.0
FAST_RAD_S: Annotated[
    float, Means("rad/s, wheel side", "what every bench for an axle allows", "separating")
] = 40.0
SHAFT_SHARE: Annotated[
    float,
    Means(
        "of the torque request times the gear ratio",
        "shaft torque at most: a resonance gives more than its drive",
        "separating",
    ),
] = 2.5
SHARES: Annotated[
    tuple[float, ...], Means("of the largest torque", "tried in turn until all limits are kept", "separating")
] = (1.0, 0.6, 0.35, 0.2)
WHEEL_RADIUS_M: Annotated[
    float, Means("m", "typical: only the speed at which a test begins depends on it", "separating")
] = 0.33
SLOW_KM_H: Annotated[float, Means("km/h", "speed of a chirp", "separating")] = 12.0
FAST_KM_H: Annotated[float, Means("km/h", "speed from which the axle coasts", "separating")] = 36.0

CHANNEL_NOISES: Annotated[
    float, Means("gap over noise floor", "up to it a channel's gap is closed", "held_out")
] = 1.5
EVENT_S: Annotated[
    float,
    Means("s", "over which a held-out recording may be far off: a limit met but once", "held_out"),
] = 0.1
EVENT_NOISES: Annotated[
    float,
    Means(
        "noise levels",
        "rms over that time from which on nothing explains it; noise itself never does",
        "held_out",
    ),
] = 3.0
TOLERANCES: Annotated[
    float,
    Means(
        "times the tolerance of the model's own dead time",
        "an extra dead time that is smaller is a correction of it",
        "least",
    ),
] = 2.0
WORDS_SEGMENT: Annotated[int, Means("blocks", "of a spectrum that is stated in words", "words")] = 1024
LINE_WIDTH: Annotated[int, Means("frequencies", "lines that are no further apart are one line", "words")] = 2
CHANNEL_SHARE: Annotated[
    float, Means("of the strongest channel's power", "an effect acts in channels above it", "words")
] = 0.3
EVERYWHERE: Annotated[
    float,
    Means("times the median condition", "an effect that falls by less acts at all conditions", "words"),
] = 2.0
BAND_SHARES: Annotated[
    tuple[float, float], Means("of the power", "the band that is stated lies between", "words")
] = (0.1, 0.9)
