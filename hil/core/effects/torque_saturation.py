"""The acting torque is clipped."""

from __future__ import annotations

import math
from collections.abc import Iterator

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import STRETCH, Direction, Probe, Scene


def _clip(torque: float, values: Values) -> float:
    (limit,) = values
    return min(max(torque, -limit), limit)


def _probes(scene: Scene) -> Iterator[Probe]:
    for share in (0.97, 0.92, 0.85, 0.75, 0.65, 0.55, 0.45, 0.35, 0.25):
        yield _clipped(scene.torque_nm, share)


def _clipped(torque: float, share: float) -> Probe:
    """A saturation; its response goes about with what it cuts off."""
    direction = Direction({"limit_nm": share * torque}, *STRETCH)
    return Probe((direction,), lambda a: {"limit_nm": max(1.0 - float(a[0]) * (1.0 - share), 0.05) * torque})


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
