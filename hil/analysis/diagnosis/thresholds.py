"""Thresholds of the diagnosis: what is refused, what is a gap, what is stated; and the page that shows them.

Each stands beside its unit, what it decides, and the check that shows whether a changed one is still right.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple, get_type_hints


class Means(NamedTuple):
    """Unit of a threshold, what it decides, and the check (a key of `CHECKS`) that shows if it is right."""

    unit: str
    decides: str
    checked_by: str


_TESTS = ".venv/bin/python -m pytest tests/hil/analysis/diagnosis/{}"
#: The command behind each name of a check.
CHECKS = {
    "bad_input": _TESTS.format("test_bad_input.py"),
    "gap": _TESTS.format("data/test_gap.py"),
    "consequences": _TESTS.format("findings/test_consequences.py"),
    "least": _TESTS.format("findings/test_named.py"),
    "separating": _TESTS.format("findings/test_separating.py"),
    "held_out": _TESTS.format("findings/test_held_out.py"),
    "words": _TESTS.format("findings/test_named.py"),
}

# Data: what is refused, what is noise, what is a gap.
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
SLOW_NOISE: Annotated[float, Means("times white noise's power", "an octave may have", "bad_input")] = 3.0
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
STANDSTILL_SHARE: Annotated[
    float, Means("of the largest speed", "below it the axle is near standstill", "gap")
] = 0.03
REVERSAL_S: Annotated[
    float, Means("s", "so long after torque changes its sign counts as reversal", "gap")
] = 0.15
LARGE: Annotated[
    float, Means("of the largest torque or speed", "above it torque is large, or speed high", "gap")
] = 0.6
WORSE: Annotated[
    float, Means("times the error before", "a band of a channel with more was made worse", "gap")
] = 1.5
WORSE_NOISES: Annotated[
    float, Means("error over noise", "and with less than this no one would see it", "gap")
] = 3.0

# Findings: verdict, confidence, words, separating tests.
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

_HEAD = """# Thresholds of the diagnosis

Made by `page()` of `hil.analysis.diagnosis.thresholds`; a test
compares. They are heuristics: what each decides, and which check shows if a changed one is still right.
Sizes at which effects are tried, and how far fits move them, stand with the effects (`hil/core/effects`).

| check | command |
|---|---|
"""


def thresholds() -> Iterator[tuple[str, Any, Means]]:
    """Name, value and meaning of every threshold."""
    here = sys.modules[__name__]
    for name, hint in get_type_hints(here, include_extras=True).items():
        yield name, getattr(here, name), hint.__metadata__[0]


def page() -> str:
    """The page as Markdown."""
    checks = "".join(f"| {name} | `{command}` |\n" for name, command in CHECKS.items())
    rows = [
        f"| `{name}` | {_shown(value)} | {means.unit} | {means.decides} | {means.checked_by} |\n"
        for name, value, means in thresholds()
    ]
    head = "\n| name | value | unit | decides | check |\n|---|---|---|---|---|\n"
    return _HEAD + checks + head + "".join(rows)


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_shown, value))})"
    if isinstance(value, dict):
        return ", ".join(f"{name} {_shown(each)}" for name, each in value.items())
    return f"{value:.6g}"
