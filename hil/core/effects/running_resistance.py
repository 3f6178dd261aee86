"""Constant plus speed-squared load on the vehicle inertia."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Direction, Probe, Scene
from hil.core.effects._smooth import tanh

# Width of a smooth sign function: small against any speed of interest, large enough for steps of 0.1 ms.
_ROLLING_WIDTH_RAD_S = 0.05


def _load(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    rolling, aero = values
    speed = motion.vehicle_speed
    return rolling * tanh(speed / _ROLLING_WIDTH_RAD_S) + aero * speed * abs(speed)


def _probes(scene: Scene) -> Iterator[Probe]:
    rolling = Direction({"rolling_nm": 5.0, "aero_nms2_rad2": 0.0}, 0.0, 60.0)
    aero = Direction({"rolling_nm": 0.0, "aero_nms2_rad2": 0.01}, 0.0, 300.0)
    yield Probe(
        (rolling, aero),
        lambda a: {"rolling_nm": 5.0 * float(a[0]), "aero_nms2_rad2": 0.01 * float(a[1])},
    )


EFFECT = Effect(
    id="running_resistance",
    title="Running resistance",
    stage=Stage.LOAD,
    summary="Constant plus speed-squared load on the vehicle inertia.",
    signature="Speed reached falls short, more at high speed; nothing at resonance.",
    shown_by="Coast-down from a high speed.",
    parameters=(
        Parameter(
            "rolling_nm",
            "N m",
            0.0,
            1e5,
            "constant part, against the motion; below 0.05 rad/s it fades, and holds nothing at standstill",
            typical=1.0,
        ),
        Parameter(
            "aero_nms2_rad2", "N m s²/rad²", 0.0, 1e4, "part proportional to speed squared", typical=1e-3
        ),
    ),
    law=Law(load=_load),
    sizes=("rolling_nm", "aero_nms2_rad2"),
    probes=_probes,
    similar=("coulomb_friction", "viscous_drag"),
)
