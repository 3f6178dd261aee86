"""A channel is recorded late."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, reading

_LATE_S = (0.008, 0.016, 0.024, 0.032, 0.04, 0.05)


def _probes(scene: Scene) -> Iterator[Probe]:
    for channel in scene.channels:
        yield reading(channel, "delay_s", 0.0, 1e-3, -20.0, 60.0)
        for delay in _LATE_S:  # so late that the error is no longer like the channel's slope
            yield reading(channel, "delay_s", 0.0, delay, 0.0, 2.0)


EFFECT = Effect(
    id="channel_skew",
    title="Channel skew",
    stage=Stage.SENSOR,
    summary="A channel is recorded late.",
    signature="Phase lag in proportion to frequency on one channel only.",
    shown_by="A chirp up to 30 Hz.",
    parameters=(Parameter("delay_s", "s", -0.5, 0.5, "delay of the channel", typical=1e-3),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(0.05, "samples"),
    law=Law(reads="delay_s"),
    probes=_probes,
    similar=("dead_time", "actuator_lag", "sensor_lag"),
)
