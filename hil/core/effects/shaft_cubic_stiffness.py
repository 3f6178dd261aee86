"""The shaft torque gains c·stretch³."""

from __future__ import annotations

from collections.abc import Iterator

from hil.core.chain import Chain
from hil.core.effects._effect import Effect, Parameter, Stage
from hil.core.effects._law import Law, Motion, Values
from hil.core.effects._probe import Probe, Scene, scaled, sized


def _shaft(motion: Motion, chain: Chain, memory: float, values: Values) -> float:
    return values[0] * motion.stretch * motion.stretch * motion.stretch


def _probes(scene: Scene) -> Iterator[Probe]:
    stiffness = scene.parameters["shaft_stiffness"]
    twist = scene.shaft_torque_nm / stiffness
    unit = stiffness / twist**2
    yield scaled("coefficient_nm_rad3", 0.01 * unit, -20.0, 20.0)
    for share in (-0.3, -0.15, 0.15, 0.4, 1.0, 4.0, 48.0):  # of a torque that is up to four fifths of its own
        yield sized("coefficient_nm_rad3", share * unit)


EFFECT = Effect(
    id="shaft_cubic_stiffness",
    title="Cubic shaft stiffness",
    stage=Stage.SHAFT,
    summary="The shaft torque gains c·twist³.",
    signature="The resonance moves up (or down) with amplitude and with bias torque.",
    shown_by="Chirps at two amplitudes or two bias torques.",
    parameters=(
        Parameter("coefficient_nm_rad3", "N m/rad³", -1e9, 1e9, "c in T_s = k·twist + c·twist³", typical=1e4),
    ),
    needs=("two_inertia", "three_inertia"),
    law=Law(shaft=_shaft),
    probes=_probes,
    similar=("shaft_hysteresis",),
)
