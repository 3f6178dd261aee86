"""The reference plant: constants and effects in, outputs of an experiment out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.core.channels import OUTPUTS
from tests.blind.experiments import SAMPLE_S, Experiment
from tests.blind.reference.chain import simulate_chain
from tests.blind.reference.controller import control
from tests.blind.reference.layout import Constants, record
from tests.blind.reference.rigid import simulate_rigid
from tests.blind.sensors import Sensor

Array = npt.NDArray[np.float64]

#: 25 µs; sizes are searched at 100 µs.
FINE, COARSE = 40, 10


@dataclass(frozen=True)
class Truth:
    """A plant: `parameters` as in a model file of `kind`, `laws` by the names of reference.layout.

    A law given here is added to the parameter of the same name in the model file, if it has one
    (`extra_delay_s` adds to the dead time). `sensors` act on the outputs in order.
    """

    kind: str
    parameters: dict[str, float]
    laws: dict[str, float] = field(default_factory=dict)
    sensors: tuple[Sensor, ...] = ()

    def with_parameter(self, name: str, value: float) -> Truth:
        return replace(self, parameters=self.parameters | {name: value})

    def joined(self, other: Truth) -> Truth:
        """This plant with the laws and sensors of `other` as well."""
        return replace(self, laws=self.laws | other.laws, sensors=self.sensors + other.sensors)


def constants(truth: Truth) -> Constants:
    """The constants that the compiled loops read."""
    values = {name: value for name, value in truth.parameters.items() if name != "torque_delay"}
    laws = dict(truth.laws)
    values["delay_s"] = truth.parameters["torque_delay"] + laws.pop("extra_delay_s", 0.0)
    if truth.kind == "three_inertia":
        values["has_tyre"] = 1.0
    if laws.get("has_tyre"):
        values["vehicle_inertia"] -= laws["wheel_inertia"]
    return record(values | laws)


def true_outputs(
    truth: Truth,
    experiment: Experiment,
    *,
    wheel_noise: Array | None = None,
    seat: float = 0.0,
    substeps: int = FINE,
) -> tuple[Array, Array]:
    """(torque request, samples x outputs) before the sensors; `wheel_noise` enters a closed loop."""
    request = experiment.torque_nm.copy()
    noise = np.zeros_like(request) if wheel_noise is None else wheel_noise
    if experiment.closed_loop:
        inertia = truth.parameters["vehicle_inertia"]
        gain = 0.5 * inertia / truth.parameters["gear_ratio"]
        reading = [s for s in truth.sensors if s.channel == OUTPUTS[1]]
        loop = control(
            gain,
            0.1 * gain,
            gain=float(np.prod([s.gain for s in reading])),
            offset=sum(s.offset for s in reading),
        )
    else:
        loop = control()
    common = (constants(truth), request, loop, experiment.target_rad_s, noise, experiment.wheel_speed_rad_s)
    if truth.kind == "rigid":
        return request, simulate_rigid(*common, substeps, SAMPLE_S)
    return request, simulate_chain(*common, seat, substeps, SAMPLE_S)


def read_by_sensors(truth: Truth, outputs: Array, noise: Array) -> Array:
    """What the channels show: the sensors' errors on `outputs`, and `noise` before rounding."""
    shown = outputs.copy()
    for sensor in truth.sensors:
        column = OUTPUTS.index(sensor.channel)
        shown[:, column] = sensor.read(shown[:, column], SAMPLE_S)
    shown += noise
    for sensor in truth.sensors:
        column = OUTPUTS.index(sensor.channel)
        shown[:, column] = sensor.rounded(shown[:, column])
    return shown
