"""A plant prepared once, so that each draft of a controller for it is judged in milliseconds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from hil.analysis.control_design._acceptance import refuse_unstable
from hil.analysis.control_design._assembly import (
    chain_of,
    controller_of,
    refuse_resonance,
    speed_controls,
    wheel_inertia_of,
)
from hil.analysis.control_design._laws import feedback_functions, pole_assignment
from hil.analysis.control_design._loop import (
    Margins,
    feedback_response,
    loop_grid,
    margins,
    sampled_response,
)
from hil.analysis.control_design._plant import design_plant
from hil.analysis.control_design._spec import DesignSpec
from hil.analysis.plausible import within_floating_point
from hil.core.channels import OUTPUTS
from hil.core.controller import Controller
from hil.core.errors import BadInputError
from hil.core.model import Model

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_POINTS = 1500


@dataclass(frozen=True)
class Draft:
    """A controller on the model itself; nothing is stated of other plants (`design` does).

    Attributes:
        controller: as `design` would make it.
        loop: F values of its open loop as sampled, on the drafts' frequencies.
        pi_loop: the same without lead or notch.
        margins: of `loop`.
        unstable: why the closed loop grows; '' if it does not.
        notes: what was changed of the plant, and why.
    """

    controller: Controller
    loop: ComplexArray
    pi_loop: ComplexArray
    margins: Margins
    unstable: str
    notes: tuple[str, ...]


class Drafts:
    """Drafts for one model.

    Attributes:
        frequency_hz: F frequencies of every draft's loops.
        chain: inertias and springs to simulate a step on: the model, or the chain nearest to its functions.
        is_fitted: whether `chain` is not the model itself.

    Raises:
        BadInputError: as of `design`, where it is about the model.
    """

    def __init__(self, model: Model, sample_time_s: float = DesignSpec.sample_time_s) -> None:
        with within_floating_point("this model"):
            self.plant = design_plant(model)
            self._model, self._step = model, sample_time_s
            self._motor = self.plant.functions[OUTPUTS[0]]
            self._origin_poles = 2 if self._motor.denominator[-1] == 0 else 1
            self.frequency_hz = loop_grid(sample_time_s, _POINTS)
            self._held = sampled_response(self._motor, self.frequency_hz, sample_time_s)
            self._source = model.source
            self.is_fitted = model.kind == "transfer_function"
            self.chain = chain_of(self.plant) if self.is_fitted else model
            self._notes: list[str] = list(self.plant.notes)
            self._wheel_inertia = wheel_inertia_of(model, DesignSpec(), self.plant, self._notes)

    def draft(self, spec: DesignSpec) -> Draft:
        """Judge one choice; also an unstable one.

        Raises:
            BadInputError: values out of range, or no controller that the RMCU can use.
        """
        spec.check()
        refuse_resonance(spec, self.plant.resonance_hz, self._source)
        if spec.sample_time_s != self._step:
            raise BadInputError("another sample time than the drafts were prepared for")
        given = replace(spec, wheel_inertia_kg_m2=spec.wheel_inertia_kg_m2 or self._wheel_inertia)
        with within_floating_point("this model"):
            return self._judged(given)

    def _judged(self, spec: DesignSpec) -> Draft:
        gains = pole_assignment(spec.inertia_kg_m2 or self.plant.inertia_kg_m2, spec.pole_rad_s)
        wscs = speed_controls(spec, gains, self.plant.resonance_hz)
        wsc = wscs[spec.stabilisation]
        blocks = feedback_functions(wsc)
        loop = self._held * feedback_response(blocks, self.frequency_hz, self._step)
        found = margins(self.frequency_hz, loop, self._origin_poles)
        unstable = ""
        try:
            refuse_unstable(self._motor, blocks, spec, found)
        except BadInputError as error:
            unstable = error.what
        controller = controller_of(self._model, spec, self.plant, wsc, [], ())
        pi = self._held * feedback_response(feedback_functions(wscs["pi"]), self.frequency_hz, self._step)
        return Draft(controller, loop, pi, found, unstable, tuple(self._notes))
