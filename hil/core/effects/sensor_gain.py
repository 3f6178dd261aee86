"""A channel reads gain times the true value."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, reading


def _probes(scene: Scene) -> Iterator[Probe]:
    for channel in scene.channels:
        yield reading(channel, "gain", 1.0, 0.01, -60.0, 180.0)


EFFECT = Effect(
    id="sensor_gain",
    title="Sensor gain",
    stage=Stage.SENSOR,
    summary="A channel reads gain times the true value.",
    signature="One channel off by the same factor at all frequencies and speeds.",
    shown_by="Any test that moves the channel.",
    parameters=(Parameter("gain", "", -100.0, 100.0, "reading / true value", typical=0.01),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    off=1.0,
    least=Least(5e-4),
    law=Law(reads="gain"),
    probes=_probes,
)
