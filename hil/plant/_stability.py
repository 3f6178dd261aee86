"""Whether the integrator's fixed steps carry a model: asked where it comes in, and of what came out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.plant import slots as P
from hil.plant import states as X
from hil.plant._linear import system

Array = npt.NDArray[np.float64]

LONGEST_STEP_S = 1e-4
_DIVERGED = 1e12
#: No axle turns or twists by more, rad/s and rad; what does is arithmetic.
_NO_AXLE = 1e6
_RATES = (X.ROTOR_SPEED, X.WHEEL_SPEED, X.TWIST)
_ROUNDING = 1e-6
_FIX = "look for a damping or stiffness too large for steps of {step_ms:g} ms, or an inertia too small"


def is_stable(model: Model, longest_step_s: float = LONGEST_STEP_S) -> bool:
    """Whether steps of this length keep every motion of the model's chain from growing by themselves."""
    return _worst(model, longest_step_s) is None


def refuse_too_stiff(model: Model, longest_step_s: float = LONGEST_STEP_S) -> None:
    """Refuse a model whose simulation would diverge, before anything moves.

    Args:
        longest_step_s: of the integrator.

    Raises:
        BadInputError: names the model, and its fastest motion.
    """
    worst = _worst(model, longest_step_s)
    if worst is not None:
        raise BadInputError(
            f"the simulation diverges: the model's fastest motion, {abs(worst) / (2.0 * np.pi):.3g} Hz, "
            "is too fast for the integrator",
            where=model.source or "the model",
            fix=_FIX.format(step_ms=longest_step_s * 1e3),
        )


def refuse_divergence(channels: Mapping[str, Array], time_s: Array, model: Model) -> None:
    """Refuse numbers that no axle has: an unstable model, or one too stiff for the integrator's steps.

    Raises:
        BadInputError: names the model, the channel and since when.
    """
    for name, values in channels.items():
        bad = ~(np.abs(values) < _DIVERGED)
        if bad.any():
            since_s = time_s[np.argmax(bad)]
            _refuse(model.source, f"{name} is beyond {_DIVERGED:g} from {since_s:g} s on", LONGEST_STEP_S)


def refuse_diverged_state(x: Array, time_s: float, source: str, longest_step_s: float) -> None:
    """The same of the state of a simulated bench at a time in seconds.

    Args:
        source: of the model.

    Raises:
        BadInputError: names the model and when.
    """
    if not all(-_NO_AXLE < x[state] < _NO_AXLE for state in _RATES):  # asked very often
        _refuse(source, f"by {time_s:.3f} s speed or twist of the axle is not plausible", longest_step_s)


def _refuse(source: str, what: str, longest_step_s: float) -> NoReturn:
    raise BadInputError(
        f"the simulation diverges: {what}",
        where=source or "the model",
        fix=_FIX.format(step_ms=longest_step_s * 1e3),
    )


def _worst(model: Model, longest_step_s: float) -> complex | None:
    """The fastest rate (1/s) that Runge-Kutta steps of this length let grow and nature does not."""
    if model.kind == "transfer_function":
        return None  # its functions are propagated from sample to sample exactly
    rates = np.linalg.eigvals(system(P.pack(model))[0])
    z = rates * longest_step_s
    by_steps = np.abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0))))
    grow = by_steps > np.maximum(1.0, np.exp(np.minimum(z.real, 50.0))) + _ROUNDING
    return complex(rates[grow][np.argmax(np.abs(rates[grow]))]) if grow.any() else None
