"""Models from frequency responses: rational functions with dead time, and driveline chains."""

from hil.analysis.identification._alternatives import (
    OrderModel,
    Resonance,
    chain_models,
    information_criterion,
    order_models,
    resonances_of,
)
from hil.analysis.identification._chain import (
    CHAINS,
    chain_polynomials,
    chain_response,
    transfer_functions_of,
)
from hil.analysis.identification._chain_fit import (
    TOLERANCE_DB,
    TOLERANCE_DEG,
    ChainChoice,
    ChainFit,
    Misfit,
    choose_chain,
    fit_chain,
)
from hil.analysis.identification._identify import Identification, identify
from hil.analysis.identification._modal import Modes, Structure
from hil.analysis.identification._order import ORDERS, Candidate, OrderChoice, choose_order
from hil.analysis.identification._rational_fit import Fit, expected_deviation, fit
from hil.analysis.identification._table import fit_of, model_of, stated_errors
from hil.analysis.identification._trust import (
    LARGEST_DISTORTION,
    LARGEST_EXCESS,
    LARGEST_MISFIT,
    LEAST_COHERENCE,
    Judgement,
    Trust,
    judge,
)

__all__ = [
    "CHAINS",
    "LARGEST_DISTORTION",
    "LARGEST_EXCESS",
    "LARGEST_MISFIT",
    "LEAST_COHERENCE",
    "ORDERS",
    "TOLERANCE_DB",
    "TOLERANCE_DEG",
    "Candidate",
    "ChainChoice",
    "ChainFit",
    "Fit",
    "Identification",
    "Judgement",
    "Misfit",
    "Modes",
    "OrderChoice",
    "OrderModel",
    "Resonance",
    "Structure",
    "Trust",
    "chain_models",
    "chain_polynomials",
    "chain_response",
    "choose_chain",
    "choose_order",
    "expected_deviation",
    "fit",
    "fit_chain",
    "fit_of",
    "identify",
    "information_criterion",
    "judge",
    "model_of",
    "order_models",
    "resonances_of",
    "stated_errors",
    "transfer_functions_of",
]
