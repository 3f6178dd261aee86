"""Why simulation and measurement differ, by one likelihood.

docs/explanation/how-a-name-is-found.md has its equations and their sources.
"""

from hil.analysis.missing_effects._explain import explain_gap
from hil.analysis.missing_effects._hypothesis import TOLERANCE
from hil.analysis.missing_effects._noise import proven_noise, white_level
from hil.analysis.missing_effects._outcome import Curve, Named, Outcome, Replay, Verdict
from hil.analysis.missing_effects._problem import SLOW_NOISE
from hil.analysis.missing_effects._series import Series, block_means, series_of
from hil.analysis.missing_effects._simulations import INTERRUPTED, OUT_OF_TIME

__all__ = [
    "INTERRUPTED",
    "OUT_OF_TIME",
    "SLOW_NOISE",
    "TOLERANCE",
    "Curve",
    "Named",
    "Outcome",
    "Replay",
    "Series",
    "Verdict",
    "block_means",
    "explain_gap",
    "proven_noise",
    "series_of",
    "white_level",
]
