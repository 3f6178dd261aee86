"""Why simulation and measurement differ, by one likelihood.

docs/explanation/how-a-name-is-found.md has its equations and their sources.
"""

from hil.analysis.missing_effects._allowance import INTERRUPTED, OUT_OF_TIME
from hil.analysis.missing_effects._explain import explain_gap
from hil.analysis.missing_effects._hypothesis import TOLERANCE
from hil.analysis.missing_effects._noise import white_level
from hil.analysis.missing_effects._outcome import Curve, Named, Outcome, Replay

__all__ = [
    "INTERRUPTED",
    "OUT_OF_TIME",
    "TOLERANCE",
    "Curve",
    "Named",
    "Outcome",
    "Replay",
    "explain_gap",
    "white_level",
]
