"""Requests smaller than the half width have no effect, larger ones are reduced by it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import Probe, Scene, sized


def _lose(torque: float, values: Values) -> float:
    (half_width,) = values
    return math.copysign(max(0.0, abs(torque) - half_width), torque)


def _probes(scene: Scene) -> Iterator[Probe]:
    for share in (0.004, 0.012, 0.03, 0.07, 0.15):
        yield sized("half_width_nm", share * scene.torque_nm, 0.2)


EFFECT = Effect(
    id="torque_deadband",
    title="Torque dead band",
    stage=Stage.TORQUE_PATH,
    summary="Requests smaller than the half width have no effect, larger ones are reduced by it.",
    signature="Small amplitudes give too little response; odd harmonics.",
    shown_by="Chirp at two amplitudes around zero torque.",
    parameters=(Parameter("half_width_nm", "N m", 0.0, 1e4, "half of the dead band's width"),),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(2e-4, "largest torque"),
    law=Law(shape=_lose),
    probes=_probes,
    abrupt=True,
)
