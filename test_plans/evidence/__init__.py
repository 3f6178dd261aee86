"""What proves that a channel was measured: it is alive, and it agrees with its neighbours in the axle."""

from test_plans.evidence._evidence import (
    FROZEN_BESIDE_WITNESS_S,
    FROZEN_S,
    LEAST_SAMPLES,
    PROOFS,
    SENSORS,
    WITNESSES,
    Repetition,
    frozen_channels,
    least_motion,
    objections,
    unproven,
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
