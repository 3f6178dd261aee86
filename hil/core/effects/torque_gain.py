"""The acting torque is gain times the request: a wrong torque constant, a weak magnet."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import Probe, Scene, around


def _scale(torque: float, values: Values) -> float:
    (gain,) = values
    return gain * torque


def _probes(scene: Scene) -> Iterator[Probe]:
    yield around(1.0, "gain", 0.01, -60.0, 180.0)


EFFECT = Effect(
    id="torque_gain",
    title="Torque gain",
    stage=Stage.TORQUE_PATH,
    summary="The acting torque is gain times the request, as with a wrong torque constant.",
    signature="All outputs off by one factor at all frequencies and amplitudes, from the motor on.",
    shown_by="Any chirp with shaft torque measured.",
    parameters=(
        Parameter(
            "gain", "", 0.01, 100.0, "acting torque / requested torque", typical=0.01, within=(0.2, 5.0)
        ),
    ),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    off=1.0,
    least=Least(0.01),
    law=Law(shape=_scale),
    probes=_probes,
)
