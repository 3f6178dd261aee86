"""A channel reads the true value plus an offset."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, reading


def _probes(scene: Scene) -> Iterator[Probe]:
    for channel in scene.channels:
        yield reading(channel, "offset", 0.0, 1.0, -60.0, 180.0)


EFFECT = Effect(
    id="sensor_offset",
    title="Sensor offset",
    stage=Stage.SENSOR,
    summary="A channel reads the true value plus an offset.",
    signature="One channel off by a constant.",
    shown_by="Any test, best with a period of standstill.",
    parameters=(Parameter("offset", "channel's", -1e6, 1e6, "added to the true value", typical=0.1),),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(5e-4, "rms reading"),
    law=Law(reads="offset"),
    probes=_probes,
)
