"""First-order lag between requested and acting torque: T·dy/dt = u - y."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, sized


def _lag(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain["torque_lag"] = values["time_constant_s"]


def _probes(scene: Scene) -> Iterator[Probe]:
    yield sized("time_constant_s", 0.001, 0.02)
    for constant in (0.002, 0.004, 0.008, 0.016, 0.032, 0.064):
        yield sized("time_constant_s", constant)


EFFECT = Effect(
    id="actuator_lag",
    title="Actuator lag",
    stage=Stage.TORQUE_PATH,
    summary="First-order lag between requested and acting torque.",
    signature="Like dead time in phase, and amplitudes fall at high frequency.",
    shown_by="A chirp up to 30 Hz with little noise: the amplitude above 15 Hz tells lag from dead time.",
    parameters=(Parameter("time_constant_s", "s", 0.0, 1.0, "time constant of the lag", within=(0.0, 0.3)),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(0.05, "samples"),
    law=Law(chain=_lag),
    probes=_probes,
    similar=("dead_time", "channel_skew"),
)
