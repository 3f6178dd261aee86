"""What proves that a channel was measured: it is alive, and it agrees with its neighbours in the axle."""

from test_plans.evidence._evidence import PROOFS, objections
from test_plans.evidence._repetition import (
    FROZEN_S,
    SENSORS,
    WITNESSES,
    Repetition,
    frozen_channels,
)

__all__ = [
    "FROZEN_S",
    "PROOFS",
    "SENSORS",
    "WITNESSES",
    "Repetition",
    "frozen_channels",
    "objections",
]
