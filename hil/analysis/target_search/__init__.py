"""Target figures in place of recordings: which effects would bring a predicted run to them."""

from hil.analysis.target_search._conditions import Condition, conditions_of
from hil.analysis.target_search._explain import (
    SEPARATING,
    Explanation,
    Rival,
    explain,
    files_of,
    model_name,
)
from hil.analysis.target_search._plausible import Candidate, Number, Scene, candidates, plausible
from hil.analysis.target_search._targets import ResponseTarget, Targets, read_targets
from hil.analysis.target_search._trial import CarryOut, Guess, Outcome, Predicted, Trial

__all__ = [
    "SEPARATING",
    "Candidate",
    "CarryOut",
    "Condition",
    "Explanation",
    "Guess",
    "Number",
    "Outcome",
    "Predicted",
    "ResponseTarget",
    "Rival",
    "Scene",
    "Targets",
    "Trial",
    "candidates",
    "conditions_of",
    "explain",
    "files_of",
    "model_name",
    "plausible",
    "read_targets",
]
