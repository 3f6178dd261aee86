"""Models whose motor torque hangs on the speed: what knows the torque beforehand cannot take them."""

from __future__ import annotations

from hil.core.effects import EFFECTS
from hil.core.errors import BadInputError
from hil.core.model import Model


def is_limited(model: Model) -> bool:
    """Whether an effect limits a model's torque by its speed."""
    return any(EFFECTS[use.id].law.limit is not None for use in model.effects)


def refuse_motor_limits(model: Model, what: str) -> None:
    """Refuse a model whose torque is limited by its speed where the acting torque is computed first.

    Raises:
        BadInputError: it is; names the model, and `what` cannot take it.
    """
    for use in model.effects:
        if EFFECTS[use.id].law.limit is not None:
            raise BadInputError(
                f"{what} computes the acting torque before the speed, and '{use.id}' needs the speed",
                where=model.source or "the model",
                fix=f"remove '{use.id}': recordings have the torque that the motor gave, as motor_torque_nm",
            )
