"""What a model is: kinds with their parameters, transfer functions, effects."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hil.core.chain import WHEEL_RADIUS_M
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS

#: Parameters by name: unit, and whether zero is possible.
PARAMETERS = {
    "motor_inertia": ("kg m²", False),
    "gear_ratio": ("motor speed / wheel speed", False),
    "shaft_stiffness": ("N m/rad", False),
    "shaft_damping": ("N m s/rad", True),
    "wheel_inertia": ("kg m²", False),
    "tyre_stiffness": ("N m/rad", False),
    "tyre_damping": ("N m s/rad", True),
    "vehicle_inertia": ("kg m²", False),
    "viscous_drag": ("N m s/rad", True),
    "torque_delay": ("s", True),
}
#: Kinds of model, and the parameters of each in file order.
MODEL_KINDS: dict[str, tuple[str, ...]] = {
    "rigid": ("motor_inertia", "gear_ratio", "vehicle_inertia", "viscous_drag", "torque_delay"),
    "two_inertia": (
        "motor_inertia",
        "gear_ratio",
        "shaft_stiffness",
        "shaft_damping",
        "vehicle_inertia",
        "torque_delay",
    ),
    "three_inertia": (
        "motor_inertia",
        "gear_ratio",
        "shaft_stiffness",
        "shaft_damping",
        "wheel_inertia",
        "tyre_stiffness",
        "tyre_damping",
        "vehicle_inertia",
        "torque_delay",
    ),
    "transfer_function": (),
}
#: The load input that is no torque: the wheels turn as recorded (a dynamometer that regulates their speed).
SPEED_INPUT = OUTPUTS[1]
#: Channels that load a model's wheels; torque is positive against forward motion, left plus right.
LOAD_INPUTS = ("dyno_torque_ref_nm", SPEED_INPUT)
#: Smallest and largest radius of a wheel.
WHEEL_RADII_M = (0.01, 10.0)


@dataclass(frozen=True)
class TransferFunction:
    """numerator/denominator in descending powers of s, times exp(-delay_s·s)."""

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    delay_s: float = 0.0

    def response(self, frequency_hz: np.ndarray) -> np.ndarray:
        """Complex response at `frequency_hz` (any shape), dead time included."""
        s = 2j * np.pi * np.asarray(frequency_hz, dtype=float)
        ratio = np.polyval(self.numerator, s) / np.polyval(self.denominator, s)
        return np.asarray(ratio * np.exp(-self.delay_s * s))


@dataclass(frozen=True)
class EffectUse:
    """An effect of the registry with its values, as a model carries it."""

    id: str
    values: dict[str, float | str]


@dataclass(frozen=True)
class Model:
    """A plant model; the input is `motor_torque_ref_nm`, the outputs are `OUTPUTS`.

    `load_input` names a recorded channel whose torque brakes the wheels (the load where there is no wheel),
    beside what the model itself holds of the vehicle, or whose speed they have (`SPEED_INPUT`); '' for none.
    """

    kind: str
    parameters: dict[str, float] = field(default_factory=dict)
    effects: tuple[EffectUse, ...] = ()
    transfer_functions: dict[str, TransferFunction] = field(default_factory=dict)
    meta: dict[str, Any] = field(default_factory=dict)
    wheel_radius_m: float = WHEEL_RADIUS_M
    #: How well parameters are known, relative; those not named have the default of who asks.
    tolerance: dict[str, float] = field(default_factory=dict)
    load_input: str = ""
    #: What it was read from, for messages; '' for one that was made.
    source: str = field(default="", compare=False, repr=False)

    @property
    def dead_time_s(self) -> float:
        """Dead time of the torque path by its own numbers, without effects; of functions the shortest."""
        delays = [function.delay_s for function in self.transfer_functions.values()]
        return min(delays) if delays else self.parameters["torque_delay"]

    @property
    def doubt(self) -> str:
        """What the identification that wrote it says against its use; '' if nothing."""
        warning = self.meta.get("warning")
        if isinstance(warning, str) and warning:
            return warning
        if self.meta.get("explains_the_data") is False:
            return "the chain does not explain the data that it was identified from"
        return ""

    def with_parameters(self, **changes: float) -> Model:
        """The same model with other parameter values."""
        parameters = self.parameters | changes
        return dataclasses.replace(self, parameters=parameters, meta=dict(self.meta))

    def with_effects(self, *effects: EffectUse) -> Model:
        """The same model with `effects` in place of its own."""
        return dataclasses.replace(
            self, parameters=dict(self.parameters), effects=effects, meta=dict(self.meta)
        )


def parameter_names(kind: str) -> tuple[str, ...]:
    """Names of the parameters that a model of `kind` has, in file order."""
    return MODEL_KINDS[kind]


def kind_of(kind: str, uses: Iterable[EffectUse]) -> str:
    """The kind that a model of `kind` is with effects added."""
    for use in uses:
        kind = EFFECTS[use.id].makes or kind
    return kind


def parameter_of_effect(use: EffectUse, number: str) -> str:
    """Name of an effect's number among a model's parameters: its id, what it speaks of, the number."""
    about = [value for value in use.values.values() if isinstance(value, str)]
    return ".".join([use.id, *about, number])


def parameter_unit(name: str) -> str:
    """Unit of a model parameter, or of an effect's number (`parameter_of_effect`), for people."""
    id_, _, number = name.partition(".")
    return EFFECTS[id_].parameter(number.rpartition(".")[2]).unit if number else PARAMETERS[name][0]
