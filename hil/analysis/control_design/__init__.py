"""Controllers from models, the paper's way, and how well they hold."""

from hil.analysis.control_design._acceptance import (
    LARGEST_SENSITIVITY,
    LEAST_GAIN_MARGIN_DB,
    LEAST_PHASE_MARGIN_DEG,
)
from hil.analysis.control_design._closed_loop import closed_loop_poles
from hil.analysis.control_design._design import design, measured_loop
from hil.analysis.control_design._drafts import Draft, Drafts
from hil.analysis.control_design._laws import (
    DiscreteFilter,
    Normalisation,
    feed_forward,
    feedback_functions,
    lead,
    lead_function,
    notch_function,
    observer_filter,
    pole_assignment,
    speed_filter,
    tustin,
)
from hil.analysis.control_design._loop import (
    Margins,
    encirclements,
    feedback_response,
    hold_response,
    loop_grid,
    margins,
    sampled_response,
)
from hil.analysis.control_design._optimize import (
    MarginLimits,
    Objective,
    Optimum,
    TradeOff,
    optimize,
    trade_off,
)
from hil.analysis.control_design._plant import (
    DesignPlant,
    PlantSet,
    design_plant,
    possible_plants,
    resonance_hz,
)
from hil.analysis.control_design._spec import Design, DesignSpec, Loop, Robustness
from hil.core.channels import COMFORT_BAND_HZ

__all__ = [
    "COMFORT_BAND_HZ",
    "LARGEST_SENSITIVITY",
    "LEAST_GAIN_MARGIN_DB",
    "LEAST_PHASE_MARGIN_DEG",
    "Design",
    "DesignPlant",
    "DesignSpec",
    "DiscreteFilter",
    "Draft",
    "Drafts",
    "Loop",
    "MarginLimits",
    "Margins",
    "Normalisation",
    "Objective",
    "Optimum",
    "PlantSet",
    "Robustness",
    "TradeOff",
    "closed_loop_poles",
    "design",
    "design_plant",
    "encirclements",
    "feed_forward",
    "feedback_functions",
    "feedback_response",
    "hold_response",
    "lead",
    "lead_function",
    "loop_grid",
    "margins",
    "measured_loop",
    "notch_function",
    "observer_filter",
    "optimize",
    "pole_assignment",
    "possible_plants",
    "resonance_hz",
    "sampled_response",
    "speed_filter",
    "trade_off",
    "tustin",
]
