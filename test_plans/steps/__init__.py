"""Kinds of steps, by name: one file a kind; other packages add theirs by entry point `hil.steps`."""

from test_plans.registry import Registry
from test_plans.steps._excitation import Excitation
from test_plans.steps._step import SAMPLE_TIME_S, Duration, Name, Seconds, Step, Torque
from test_plans.steps.chirp import Chirp
from test_plans.steps.coast import Coast
from test_plans.steps.hold_speed import HoldSpeed
from test_plans.steps.multisine import Multisine
from test_plans.steps.operator_prompt import PICTURE, OperatorPrompt
from test_plans.steps.ramp import Ramp
from test_plans.steps.ramp_down import RampDown
from test_plans.steps.repeat import LARGEST_COUNT, Repeat
from test_plans.steps.set_controller import FileSearch, SetController, designed_file
from test_plans.steps.set_slip import SetSlip
from test_plans.steps.set_vehicle import SetVehicle
from test_plans.steps.stairs import Stairs
from test_plans.steps.step import TorqueStep
from test_plans.steps.wait import Wait

_OWN: tuple[type[Step], ...] = (
    SetController,
    HoldSpeed,
    SetSlip,
    SetVehicle,
    TorqueStep,
    Chirp,
    Multisine,
    Ramp,
    Stairs,
    Wait,
    Coast,
    OperatorPrompt,
    Repeat,
    RampDown,
)

STEPS: Registry[Step] = Registry("step", "hil.steps", Step, [(step.kind, step) for step in _OWN])  # type: ignore[type-abstract]

__all__ = [
    "LARGEST_COUNT",
    "PICTURE",
    "SAMPLE_TIME_S",
    "STEPS",
    "Chirp",
    "Coast",
    "Duration",
    "Excitation",
    "FileSearch",
    "HoldSpeed",
    "Multisine",
    "Name",
    "OperatorPrompt",
    "Ramp",
    "RampDown",
    "Repeat",
    "Seconds",
    "SetController",
    "SetSlip",
    "SetVehicle",
    "Stairs",
    "Step",
    "Torque",
    "TorqueStep",
    "Wait",
    "designed_file",
]
