"""A channel is rounded to steps."""

from __future__ import annotations

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law

EFFECT = Effect(
    id="sensor_quantization",
    title="Sensor quantization",
    stage=Stage.SENSOR,
    summary="A channel is rounded to steps.",
    signature="Readings lie on a grid; noise of step²/12.",
    shown_by="A slow ramp.",
    parameters=(Parameter("step", "channel's", 1e-12, 1e6, "distance between readings", fitted=False),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    law=Law(reads="step"),
)
