"""What a model says of slow motion: gear ratio and inertias; and which outputs it has at all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hil.analysis.diagnosis.data.thresholds import SLOW_HZ
from hil.core.channels import OUTPUTS, read_from
from hil.core.errors import BadInputError
from hil.core.model import Model
from hil.core.recording import Recording
from hil.plant import gear_ratio_of

_MOTOR, _WHEEL, _SHAFT = OUTPUTS


@dataclass(frozen=True)
class SlowMotion:
    """An axle that turns as a whole; inertias are of the wheel side."""

    gear_ratio: float
    inertia_kg_m2: float
    rotor_kg_m2: float


def slow_motion_of(model: Model) -> SlowMotion | None:
    """Gear ratio, all that turns, and the rotor's share of it; None where functions do not tell."""
    if not model.transfer_functions:
        p = model.parameters
        rotor = p["motor_inertia"] * p["gear_ratio"] ** 2
        return SlowMotion(p["gear_ratio"], rotor + p.get("wheel_inertia", 0.0) + p["vehicle_inertia"], rotor)
    ratio = gear_ratio_of(model)
    if ratio is None or _SHAFT not in model.transfer_functions:
        return None
    at = np.array(SLOW_HZ)
    wheel, shaft = (abs(complex(model.transfer_functions[name].response(at))) for name in (_WHEEL, _SHAFT))
    inertia = ratio / (2.0 * np.pi * SLOW_HZ * wheel)
    rotor = inertia * (1.0 - shaft / ratio)
    return SlowMotion(ratio, inertia, rotor) if 0.0 < rotor < inertia else None


def with_outputs_of(model: Model, recording: Recording) -> Recording:
    """The recording without the outputs that a transfer-function model has no function for; a note says so.

    Raises:
        BadInputError: nothing would be left to compare.
    """
    if not model.transfer_functions:
        return recording
    measured = read_from(recording)
    lacking = [channel for name, channel in measured.items() if name not in model.transfer_functions]
    if not lacking:
        return recording
    if len(lacking) == len(measured):
        raise BadInputError(
            f"the model has no function for any of its outputs: {', '.join(measured.values())}",
            where=str(recording.source),
            fix="add [transfer_functions] of one of them to the model file, or record what the model shows",
        )
    notes = [*recording.notes, f"the model has no function for {', '.join(lacking)}: not compared"]
    return replace(recording.without(lacking), notes=notes)
