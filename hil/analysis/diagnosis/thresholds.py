"""Thresholds of the diagnosis: what is refused, what is a gap, what is stated; and the page that shows them.

Behind each stands its unit and what it decides, above it the check that shows if another is still right.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from typing import Any, NamedTuple

# Checked by bad_input
LIKELIER = 1e3  #: times likelier | a mistake than none is refused
ALIKE = 0.1  #: 0 alike, 1 unrelated, 2 opposite | how unlike what belongs together is on average
ALIKE_SPEEDS = 0.02  #: of the same | where a model says that both speeds go together
TREND = 2  #: degree | of what is left aside: initial speeds, what loads the axle evenly
ANYTHING = 0.25  #: probability | that in an octave nothing goes together, though nothing is mistaken
FREE_SIZE = 0.5  #: log | by which sizes by model and as recorded differ
LARGER_SIZE = 0.25  #: log | by which outputs are all above a model's: less torque comes than was asked for
GEAR_SIZE = 0.12  #: log | by which the ratio of speeds differs from the model's
ANY_SIZE = 3.0  #: log | by which sizes in another unit differ
SHOWS = 10.0  #: times the noise's power | an octave with less says nothing
SLOW_NOISE = 3.0  #: times white noise's power | an octave may have
PLAY_RAD = 0.08  #: rad rms, wheel side | and the twist: a speed that turns less may be held
PLATEAU_SAMPLES = 20  #: samples | a shorter plateau is no clip; how far around one readings are looked at
STEPS = 5.0  #: steps of the reading | readings that move by more would show it, and run steeply into a clip
TORQUE_MOVES = 0.1  #: of its range | torque that moves more should leave a mark in a plateau
FREEZE_WINDOWS_S = (1.0, 4.0)  #: s | a channel that holds a value for so long as others move on is frozen
HOLDS_SHARE = 1e-3  #: of what a channel does in all | a channel that does less holds a value
TURNS_ON = 0.3  #: of what a channel does in all | torque and speed that do more move on

# Checked by gap
VISIBLE = 1.5  #: times noise, or the error before | a channel with more moves, is open, was made worse
FAR_NOISES = 3.0  #: error over noise | a band or a moment with more is told
MOMENT_S = 0.2  #: s | a driveline's own motion: a reversal, a rattle, a limit that is met; or a lost telegram
STANDSTILL_SHARE = 0.05  #: of the largest speed | below it the axle is near standstill
LARGE = 0.6  #: of the largest torque or speed | above it torque is large, or speed high

# Checked by separating
WORTH_A_PLAN = 0.02  #: probability | a less likely rival gets no plan
DURATION_S = 20.0  #: s | of a separating test
TELLS = 10.0  #: noise levels, root of the sum of squares | a test must tell two models by
NUMBERS_FREE = 0.1  #: of a number | by which a fit of the test's recording may change it
SETTLE_S = 2.0  #: s | a speed is held before it
SHARES = (1.0, 0.6, 0.35, 0.2)  #: of the largest torque | tried in turn until all limits are kept
WHEEL_RADIUS_M = 0.33  #: m | typical: only the speed at which a test begins depends on it
SLOW_KM_H = 12.0  #: km/h | speed of a chirp
FAST_KM_H = 36.0  #: km/h | speed from which the axle coasts

# Checked by consequences
STEP_NM = 20.0  #: N m | the step whose overshoot is stated
STEP_FROM_RAD_S = 5.0  #: rad/s | wheel speed from which it is made
LASTING = 0.1  #: of its peak | must last of the shaft torque for an overshoot to be stated

# Checked by named
TOLERANCES = 2.0  #: times the tolerance of the model's own dead time | a smaller extra one corrects it
WORDS_SEGMENT = 1024  #: blocks | of a spectrum that is stated in words
LINE_WIDTH = 2  #: frequencies | lines that are no further apart are one line
CHANNEL_SHARE = 0.3  #: of the strongest channel's power | an effect acts in channels above it
EVERYWHERE = 2.0  #: times the median condition | an effect that falls by less acts at all conditions
BAND_SHARES = (0.1, 0.9)  #: of the power | the band that is stated lies between

_TESTS = ".venv/bin/python -m pytest tests/hil/analysis/diagnosis/"
#: The command behind each name of a check.
CHECKS = {
    "bad_input": f"{_TESTS}test_bad_input.py",
    "gap": f"{_TESTS}data/test_gap.py",
    "separating": f"{_TESTS}findings/test_separating.py",
    "consequences": f"{_TESTS}findings/test_consequences.py",
    "named": f"{_TESTS}findings/test_named.py",
}

_HEAD = """# Thresholds of the diagnosis

Made by `page()` of `hil.analysis.diagnosis.thresholds`; a test
compares. They are heuristics: what each decides, and which check shows if a changed one is still right.
Sizes at which effects are tried, and how far fits move them, stand with the effects (`hil/core/effects`).

| check | command |
|---|---|
"""


class Threshold(NamedTuple):
    """A threshold, its unit, what it decides, and the check (a key of `CHECKS`) that shows if it is right."""

    name: str
    value: Any
    unit: str
    decides: str
    checked_by: str


def thresholds() -> Iterator[Threshold]:
    """All of them, as they stand above."""
    here, check = sys.modules[__name__], ""
    for line in inspect.getsource(here).splitlines():
        if line.startswith("# Checked by "):
            check = line.removeprefix("# Checked by ")
        elif found := re.fullmatch(r"([A-Z_]+) = .+  #: (.+) \| (.+)", line):
            yield Threshold(found[1], getattr(here, found[1]), found[2], found[3], check)


def page() -> str:
    """The page as Markdown."""
    checks = "".join(f"| {name} | `{command}` |\n" for name, command in CHECKS.items())
    rows = [
        f"| `{one.name}` | {_shown(one.value)} | {one.unit} | {one.decides} | {one.checked_by} |\n"
        for one in thresholds()
    ]
    head = "\n| name | value | unit | decides | check |\n|---|---|---|---|---|\n"
    return _HEAD + checks + head + "".join(rows)


def _shown(value: Any) -> str:
    return f"({', '.join(map(_shown, value))})" if isinstance(value, tuple) else f"{value:.6g}"
