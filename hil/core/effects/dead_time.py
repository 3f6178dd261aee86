"""More dead time in the torque path than the model has: the acting torque is u(t - T - extra)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hil.core.effects._effect import Effect, Least, Parameter, Stage
from hil.core.effects._law import Law
from hil.core.effects._probe import Probe, Scene, scaled, sized


def _later(chain: dict[str, float], values: Mapping[str, Any]) -> None:
    chain["torque_delay"] = max(0.0, chain["torque_delay"] + values["extra_delay_s"])


def _probes(scene: Scene) -> Iterator[Probe]:
    yield scaled("extra_delay_s", 5e-4, 0.0, 8.0)
    for delay in (0.003, 0.008, 0.016, 0.03):
        yield sized("extra_delay_s", delay)


EFFECT = Effect(
    id="dead_time",
    title="Extra dead time",
    stage=Stage.TORQUE_PATH,
    summary="The torque path has more dead time than the model.",
    signature="Phase lag that grows in proportion to frequency, on all outputs alike; amplitudes unchanged.",
    shown_by="A chirp or multisine up to 30 Hz.",
    parameters=(
        Parameter("extra_delay_s", "s", -0.05, 0.5, "added to the model's torque_delay", typical=1e-3),
    ),
    needs=("rigid", "two_inertia", "three_inertia", "transfer_function"),
    least=Least(0.05, "samples"),
    law=Law(chain=_later),
    probes=_probes,
    similar=("actuator_lag", "channel_skew"),
)
