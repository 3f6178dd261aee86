"""Why simulation and measurement differ, by one likelihood: the diagnosis that is to follow the one in use.

docs/explanation/how-a-name-is-found.md has its equations and their sources.
"""

from hil.analysis.missing_effects._explain import explain_gap
from hil.analysis.missing_effects._fit import likely_moves
from hil.analysis.missing_effects._outcome import Curve, Gap, Named, Outcome, Replay

__all__ = ["Curve", "Gap", "Named", "Outcome", "Replay", "explain_gap", "likely_moves"]
