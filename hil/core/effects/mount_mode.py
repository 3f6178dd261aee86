"""The housing turns on its bushes under the reaction torque; the motor speed is measured against it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Direction, Probe, Scene
from hil.core.effects._probe import Values as Named


def _bushes(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain["housing_inertia"] = values["housing_inertia_kg_m2"]
    chain["mount_stiffness"] = values["mount_stiffness_nm_rad"]
    chain["mount_damping"] = values["mount_damping_nms_rad"]


def _probes(scene: Scene) -> Iterator[Probe]:
    """First heavy and light housings by turns: beside either, the frequency shows."""
    for step in range(16):
        omega = 2.0 * math.pi * 2.5 * 16.0 ** (step / 15)
        for damping in (0.04, 0.12, 0.35):
            for turn, inertia in enumerate((3.0, 30.0)):
                first = damping == 0.12 and step % 2 == turn
                yield _mounted(omega, damping, inertia).at(step, first=first)


def _mounted(omega: float, damping: float, inertia: float) -> Probe:
    """A mount mode; its response goes about with the inverse of its inertia at the same frequency."""

    def values(share: float) -> Named:
        heavy = inertia / share
        return {
            "housing_inertia_kg_m2": heavy,
            "mount_stiffness_nm_rad": heavy * omega**2,
            "mount_damping_nms_rad": 2 * damping * omega * heavy,
        }

    return Probe((Direction(values(1.0), 0.05, 3.0),), lambda a: values(float(a[0])))


def _derived(values: Mapping[str, float]) -> dict[str, float]:
    omega = math.sqrt(values["mount_stiffness_nm_rad"] / values["housing_inertia_kg_m2"])
    return {"mount_frequency_hz": omega / (2.0 * math.pi)}


EFFECT = Effect(
    id="mount_mode",
    title="Mount mode",
    stage=Stage.HOUSING,
    summary=(
        "The e-Axle housing turns on its bushes under the reaction torque; "
        "the motor speed is measured against the housing."
    ),
    signature="An extra resonance and anti-resonance in motor speed, much weaker at the wheel.",
    shown_by="A chirp at one amplitude over the whole band.",
    parameters=(
        Parameter("housing_inertia_kg_m2", "kg m²", 1e-6, 1e4, "inertia of the housing about the axle"),
        Parameter("mount_stiffness_nm_rad", "N m/rad", 1e-3, 1e9, "stiffness of the bushes"),
        Parameter("mount_damping_nms_rad", "N m s/rad", 0.0, 1e6, "damping of the bushes"),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(chain=_bushes),
    probes=_probes,
    similar=("shaft_cubic_stiffness",),
    derived=_derived,
)
