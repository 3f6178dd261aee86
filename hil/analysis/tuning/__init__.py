"""A controller for the largest worst margin over a plan's criteria."""

from hil.analysis.tuning._ascent import Ascent, scatter, score
from hil.analysis.tuning._confirmed import Agreement, Confirmation, confirmation
from hil.analysis.tuning._draws import Draw, differing, draws_of
from hil.analysis.tuning._driven import Driven, driven_by
from hil.analysis.tuning._free import (
    Free,
    Tolerance,
    free_from_toml,
    read_free,
    refuse_unknown_weights,
    shipped_free,
)
from hil.analysis.tuning._front import Point, front_of, metrics_of, point_of, within_hard_limits
from hil.analysis.tuning._kept import KEPT, Kept, Worse, worse_of
from hil.analysis.tuning._loops import SpeedLoops
from hil.analysis.tuning._parameters import ALTERNATIVES, PARAMETERS, Space, values_of, with_values
from hil.analysis.tuning._pool import Pool
from hil.analysis.tuning._refine import Bench, Measured, RefinedRun, Refinement, RefinementBudget, refine
from hil.analysis.tuning._search import Effort
from hil.analysis.tuning._segment_loops import (
    DrivenSegment,
    driven_segments,
    gain_factor,
    sliding,
    with_mass,
)
from hil.analysis.tuning._trial import (
    DEVICE_LIMIT,
    ENVELOPE_LIMIT,
    CarryOut,
    Predicted,
    Trial,
    Tried,
    channels_needed,
)
from hil.analysis.tuning._tune import Standing, Tuning, refuse_model, refuse_start, tune

__all__ = [
    "ALTERNATIVES",
    "DEVICE_LIMIT",
    "ENVELOPE_LIMIT",
    "KEPT",
    "PARAMETERS",
    "Agreement",
    "Ascent",
    "Bench",
    "CarryOut",
    "Confirmation",
    "Draw",
    "Driven",
    "DrivenSegment",
    "Effort",
    "Free",
    "Kept",
    "Measured",
    "Point",
    "Pool",
    "Predicted",
    "RefinedRun",
    "Refinement",
    "RefinementBudget",
    "Space",
    "SpeedLoops",
    "Standing",
    "Tolerance",
    "Trial",
    "Tried",
    "Tuning",
    "Worse",
    "channels_needed",
    "confirmation",
    "differing",
    "draws_of",
    "driven_by",
    "driven_segments",
    "free_from_toml",
    "front_of",
    "gain_factor",
    "metrics_of",
    "point_of",
    "read_free",
    "refine",
    "refuse_model",
    "refuse_start",
    "refuse_unknown_weights",
    "scatter",
    "score",
    "shipped_free",
    "sliding",
    "tune",
    "values_of",
    "with_mass",
    "with_values",
    "within_hard_limits",
    "worse_of",
]
