"""The acting torque is clipped."""

from __future__ import annotations

import math
from collections.abc import Iterator

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import Probe, Scene, clipped


def _clip(torque: float, values: Values) -> float:
    (limit,) = values
    return min(max(torque, -limit), limit)


def _probes(scene: Scene) -> Iterator[Probe]:
    yield from clipped("limit_nm", scene.torque_nm)


EFFECT = Effect(
    id="torque_saturation",
    title="Torque saturation",
    stage=Stage.TORQUE_PATH,
    summary="The acting torque is clipped.",
    signature="All outputs fall short while the request is large; small amplitudes fit.",
    shown_by="Chirp at two amplitudes, one beyond the suspected limit.",
    parameters=(Parameter("limit_nm", "N m", 1e-6, 1e6, "largest magnitude of the acting torque"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    law=Law(shape=_clip),
    off=math.inf,
    probes=_probes,
    abrupt=True,
)
