"""The acting torque's slope is clipped."""

from __future__ import annotations

import math
from collections.abc import Iterator

from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Values
from hil.core.effects._probe import Probe, Scene, fixed


def _slope(values: Values) -> float:
    return values[0]


def _probes(scene: Scene) -> Iterator[Probe]:
    for step in range(11):
        yield fixed(limit_nm_s=300.0 ** (0.1 * step) * scene.torque_nm)


EFFECT = Effect(
    id="torque_rate_limit",
    title="Torque rate limit",
    stage=Stage.TORQUE_PATH,
    summary="The acting torque's slope is clipped.",
    signature="Steps become ramps; large amplitudes at high frequency are reduced and delayed.",
    shown_by="Steps, and a chirp at two amplitudes.",
    parameters=(
        Parameter("limit_nm_s", "N m/s", 1e-6, 1e9, "largest magnitude of the acting torque's slope"),
    ),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    law=Law(slope=_slope),
    off=math.inf,
    probes=_probes,
    abrupt=True,
)
