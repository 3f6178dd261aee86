"""The reference plant: constants and effects in, outputs of an experiment out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from hil.core.channels import OUTPUTS
from tests.blind.experiments import SAMPLE_S, Experiment
from tests.blind.reference.chain import simulate_chain
from tests.blind.reference.controller import ON_MOTOR, control
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
    noise: Array | None = None,
    seat: float = 0.0,
    substeps: int = FINE,
) -> tuple[Array, Array]:
    """(torque request, samples x outputs) before the sensors; `noise`, of that shape, enters a loop."""
    request = experiment.torque_nm.copy()
    if noise is None:
        noise = np.zeros((len(request), len(OUTPUTS)))
    load = np.zeros_like(request) if experiment.load_nm is None else experiment.load_nm
    loop, target = _loop(truth, experiment)
    common = (constants(truth), request, loop, target, load, noise, experiment.wheel_speed_rad_s)
    if truth.kind == "rigid":
        return request, simulate_rigid(*common, substeps, SAMPLE_S)
    return request, simulate_chain(*common, seat, substeps, SAMPLE_S)


def _loop(truth: Truth, experiment: Experiment) -> tuple[np.void, Array]:
    """(controller, target in rad/s of what it feeds back)."""
    if not experiment.closed_loop:
        return control(), experiment.target_rad_s
    motor = experiment.motor_loop
    reading = [s for s in truth.sensors if s.channel == OUTPUTS[0 if motor else 1]]
    errors = {
        "gain": float(np.prod([s.gain for s in reading])),
        "offset": float(sum(s.offset for s in reading)),
    }
    if motor is None:
        gain = 0.5 * truth.parameters["vehicle_inertia"] / truth.parameters["gear_ratio"]
        return control(gain, 0.1 * gain, **errors), experiment.target_rad_s
    lead = {"lead_s": motor.lead_s, "lead_ratio": motor.lead_ratio, "largest_nm": motor.largest_nm}
    loop = control(motor.proportional, motor.integral, form=ON_MOTOR, **lead, **errors)
    return loop, experiment.target_rad_s * truth.parameters["gear_ratio"]


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
