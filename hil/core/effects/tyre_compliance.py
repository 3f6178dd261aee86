"""The wheel is joined to the vehicle by a compliant tyre/road coupling: a third inertia."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.chain import THREE_INERTIA
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, fixed

_LEAST_INERTIA = 1e-6
_FIRST_DAMPING = 0.6


def _coupled(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    # The two-inertia model counts the wheels with the vehicle: what becomes wheel is taken from there.
    chain["kind"] = THREE_INERTIA
    for name in ("wheel_inertia", "tyre_stiffness", "tyre_damping"):
        chain[name] = values[name]
    chain["vehicle_inertia"] = max(chain["vehicle_inertia"] - values["wheel_inertia"], _LEAST_INERTIA)


def _probes(scene: Scene) -> Iterator[Probe]:
    vehicle = scene.parameters["vehicle_inertia"]
    places = itertools.product((0.007, 0.014, 0.03, 0.06), (2.0, 4.0, 8.0, 16.0))
    for place, (share, frequency) in enumerate(places):
        for damping in (0.15, 0.6, 1.5):
            wheel, omega = share * vehicle, 2 * math.pi * frequency
            yield fixed(
                wheel_inertia=wheel,
                tyre_stiffness=wheel * omega**2,
                tyre_damping=2 * damping * omega * wheel,
            ).at(place, first=damping == _FIRST_DAMPING)


EFFECT = Effect(
    id="tyre_compliance",
    title="Tyre compliance",
    stage=Stage.TYRE,
    summary=(
        "The wheel is joined to the vehicle by a compliant tyre/road coupling: a third inertia. "
        "The wheel's inertia is taken out of the vehicle's."
    ),
    signature="An anti-resonance in wheel speed that two inertias cannot have.",
    shown_by="A chirp over 0.05 to 30 Hz with wheel speed recorded.",
    parameters=(
        Parameter("wheel_inertia", "kg m²", 1e-6, 1e4, "wheels and dyno rotors"),
        Parameter("tyre_stiffness", "N m/rad", 1e-3, 1e9, "tyre/road stiffness"),
        Parameter("tyre_damping", "N m s/rad", 0.0, 1e7, "tyre/road damping"),
    ),
    needs=("two_inertia",),
    makes="three_inertia",
    law=Law(chain=_coupled),
    probes=_probes,
)
