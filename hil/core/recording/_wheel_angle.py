"""The wheel's angle since a recording began, at which the axle stood still."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hil.core.channels import TIME, WHEEL_ANGLE
from hil.core.recording._table import Array, Recording

_SPEED = "wheel_speed_rad_s"


def with_wheel_angle(recording: Recording, spans_s: Sequence[tuple[float, float]]) -> list[Recording]:
    """Stretches of a recording, each with the wheel's angle in rad since the recording's start."""
    parts = [recording.between(*span_s) for span_s in spans_s]
    firsts = [recording.rows_before(part.first_s) if part.samples else 0 for part in parts]
    for part, angle in zip(parts, _angles_at(recording, firsts), strict=True):
        rows = part.rows(0, part.samples, (TIME, _SPEED))
        part.channels[WHEEL_ANGLE] = _turned(rows[TIME], rows[_SPEED], angle)[: part.samples]
    return parts


def _angles_at(recording: Recording, samples: Sequence[int]) -> list[float]:
    """Angles at samples by number, each block's sum started with that of the blocks before it."""
    angles = dict.fromkeys(samples, 0.0)
    last_s, last, angle = np.zeros(0), np.zeros(0), 0.0
    for first, rows in recording.blocks((TIME, _SPEED)):
        time, speed = np.concatenate([last_s, rows[TIME]]), np.concatenate([last, rows[_SPEED]])
        turned = _turned(time, speed, angle)[len(last) :]
        angles |= {
            number: float(turned[number - first]) for number in angles if 0 <= number - first < len(turned)
        }
        last_s, last, angle = time[-1:], speed[-1:], float(turned[-1])
    return [angles[number] for number in samples]


def _turned(time: Array, speed: Array, begin: float) -> Array:
    """The speed's integral by the trapezoidal rule; one that is not known turns nothing."""
    speed = np.nan_to_num(speed)
    steps = 0.5 * np.diff(time) * (speed[1:] + speed[:-1])
    return np.asarray(np.cumsum(np.concatenate([[begin], steps])))
