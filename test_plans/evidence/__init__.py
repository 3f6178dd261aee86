"""What proves that a channel was measured: it is alive, and it agrees with its neighbours in the axle."""

from test_plans.evidence._evidence import PROOFS, objections, unproven
from test_plans.evidence._repetition import (
    FROZEN_BESIDE_WITNESS_S,
    FROZEN_S,
    LEAST_SAMPLES,
    SENSORS,
    WITNESSES,
    Repetition,
    frozen_channels,
    least_motion,
)

__all__ = [
    "FROZEN_BESIDE_WITNESS_S",
    "FROZEN_S",
    "LEAST_SAMPLES",
    "PROOFS",
    "SENSORS",
    "WITNESSES",
    "Repetition",
    "frozen_channels",
    "least_motion",
    "objections",
    "unproven",
]
