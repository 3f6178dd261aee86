"""The dynamometer follows its vehicle model late: τ·ω_d' = ω_v - ω_d, and the tyre meets ω_d in place of ω_v.

Its memory is how far the dynamometer is behind, δ = ω_v - ω_d: δ' = ω_v' - δ/τ.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Memory, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, sized


def _tyre(motion: Motion, chain: Chain, behind: float, values: Values) -> float:
    return chain.tyre_damping * behind


def _tyre_rate(motion: Motion, chain: Chain, behind: float, values: Values) -> float:
    return behind


def _remember(before: Motion, after: Motion, chain: Chain, behind: float, values: Values, h: float) -> float:
    """Exact for a speed that changes evenly over the step."""
    kept = math.exp(-h / values[0])
    rise = (after.vehicle_speed - before.vehicle_speed) / h
    return behind * kept + rise * values[0] * (1.0 - kept)


def _probes(scene: Scene) -> Iterator[Probe]:
    for constant in (0.003, 0.01, 0.03, 0.1, 0.3):
        yield sized("time_constant_s", constant)


EFFECT = Effect(
    id="dyno_lag",
    title="Dynamometer lag",
    stage=Stage.LOAD,
    summary=("The dynamometer lags its vehicle model: the load's inertia is correct only for slow motion."),
    signature="The wheel swings less, as if the load were heavier the faster it moves; slow motion fits.",
    shown_by="A chirp over 0.05 to 30 Hz and a slow ramp of torque.",
    parameters=(
        Parameter(
            "time_constant_s", "s", 0.0, 10.0, "of the dynamometer behind its model", within=(1e-4, 3.0)
        ),
    ),
    needs=("three_inertia",),
    law=Law(tyre=_tyre, tyre_rate=_tyre_rate, remember=_remember),
    memory=Memory("rad/s", "lag of the dynamometer behind its vehicle model"),
    probes=_probes,
    similar=("tyre_slip",),
)
