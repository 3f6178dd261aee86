"""Effects between the truth and the recorded channel: skew, gain, offset, quantization, in that order."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from hil.core.model import Model

Array = npt.NDArray[np.float64]


def measured(model: Model, channels: dict[str, Array], dt: float) -> dict[str, Array]:
    """The channels as the model's sensors would record them, sampled every `dt` seconds."""
    seen = dict(channels)
    for kind in ("channel_skew", "sensor_gain", "sensor_offset", "sensor_quantization"):
        for use in model.effects:
            channel = str(use.values.get("channel", ""))
            if use.id == kind and channel in seen:
                seen[channel] = _READS[kind](seen[channel], use.values, dt)
    return seen


def _skewed(values: Array, effect: dict[str, float | str], dt: float) -> Array:
    at = np.arange(len(values), dtype=float)
    return np.interp(at - float(effect["delay_s"]) / dt, at, values)


def _scaled(values: Array, effect: dict[str, float | str], dt: float) -> Array:
    del dt
    return values * float(effect["gain"])


def _shifted(values: Array, effect: dict[str, float | str], dt: float) -> Array:
    del dt
    return values + float(effect["offset"])


def _rounded(values: Array, effect: dict[str, float | str], dt: float) -> Array:
    del dt
    step = float(effect["step"])
    return np.round(values / step) * step


_READS = {
    "channel_skew": _skewed,
    "sensor_gain": _scaled,
    "sensor_offset": _shifted,
    "sensor_quantization": _rounded,
}
