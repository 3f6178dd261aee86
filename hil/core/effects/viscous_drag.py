"""Drag proportional to rotor speed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, scaled


def _drag(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain["viscous_drag"] += values["coefficient_nms_rad"]


def _probes(scene: Scene) -> Iterator[Probe]:
    for unit in (1e-3, 1e-2):
        yield scaled("coefficient_nms_rad", unit, 0.0, 6.0)


EFFECT = Effect(
    id="viscous_drag",
    title="Viscous drag",
    stage=Stage.ROTOR,
    summary="Drag proportional to rotor speed.",
    signature="Speed reached falls short, in proportion to speed.",
    shown_by="A long step or coast-down over a wide speed range.",
    parameters=(
        Parameter(
            "coefficient_nms_rad", "N m s/rad", 0.0, 100.0, "drag torque per rotor speed", typical=1e-3
        ),
    ),
    law=Law(chain=_drag),
    probes=_probes,
    similar=("running_resistance",),
)
