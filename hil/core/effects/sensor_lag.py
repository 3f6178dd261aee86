"""A channel reads the truth through a first-order low-pass: T·dy/dt = truth - y."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, sized

_CONSTANTS_S = (0.002, 0.008, 0.032)


def _probes(scene: Scene) -> Iterator[Probe]:
    for channel in scene.channels:
        yield sized("time_constant_s", 0.001, 0.02, channel=channel)
        for constant in _CONSTANTS_S:
            yield sized("time_constant_s", constant, channel=channel)


EFFECT = Effect(
    id="sensor_lag",
    title="Sensor lag",
    stage=Stage.SENSOR,
    summary="A channel passes a first-order low-pass filter, such as that of an amplifier.",
    signature="One channel alone is late, and its amplitudes fall at high frequency.",
    shown_by="A chirp up to 30 Hz with little noise: the amplitude above 15 Hz tells lag from skew.",
    parameters=(
        Parameter("time_constant_s", "s", 0.0, 1.0, "time constant of the low-pass", within=(0.0, 0.3)),
    ),
    text_parameters=("channel",),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(0.05, "samples"),
    law=Law(reads="lag_s"),
    probes=_probes,
    similar=("channel_skew",),
)
