"""Identification and control design as steps of a plan: chirp, identify, design, step tests in one run.

The schema of plans needs the steps' keys only: what does the work is imported when it is done.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import ClassVar, Literal

from pydantic import Field

from hil.core.errors.extras import need
from hil.core.recording import Recording
from test_plans import Conductor, Outlook, Pace, Step
from test_plans.steps import Name, designed_file

MODEL, CHAIN, RESPONSES = "model.toml", "physical.toml", "frf.csv"


class IdentifyStep(Step):
    """Identify transfer functions and chain from the recording so far."""

    kind: ClassVar[str] = "identify"
    use: tuple[Name, ...] = Field(
        default=(), strict=False, description="segments to use; default: every chirp and multisine"
    )
    order: int | None = Field(
        default=None, ge=2, le=7, description="order of the fit; default: chosen from the data"
    )

    def execute(self, conductor: Conductor) -> None:
        """Fit, and keep model.toml, physical.toml, frf.csv and figures."""
        need("scipy")
        conductor.analyse(self.kind, self._work, (MODEL, CHAIN, RESPONSES))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """A few seconds of computing, which count on a bench with hardware."""
        del pace
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        from hil.analysis.frequency_response import experiments_of
        from hil.analysis.identification import identify
        from reports.outputs.identification import output_files

        del made
        experiments = experiments_of(recording, segments=self.use)
        return output_files(identify(experiments, order=self.order))


class DesignStep(Step):
    """Design a controller for the model of an `identify` step of this run."""

    kind: ClassVar[str] = "design"
    name: Name = Field(description="the controller's name; set_controller: {designed: NAME} loads it")
    stabilization: Literal["phase", "gain"] = Field(description="phase lead (6)(7) or notch (8)")
    pole_rad_s: float = Field(
        default=0.3, gt=0, le=10, description="pole p of the observer, rad/s (equations 4, 5)"
    )
    lead_deg: float = Field(default=36.0, gt=0, lt=90, description="phase lead P_h, degrees (equation 6)")
    lead_hz: float = Field(
        default=40.0, gt=0, le=200, description="centre frequency of the lead f_ph, Hz (equation 7)"
    )
    optimize: bool = Field(default=False, description="optimise lead and pole for the lowest sensitivity")
    torque_limit_nm: float = Field(default=150.0, gt=0, description="largest |T_m*|")

    def execute(self, conductor: Conductor) -> None:
        """Design, and keep the controller and its figures."""
        need("scipy")
        conductor.analyse(f"{self.kind} {self.name}", self._work, (str(designed_file(self.name)),))

    def outlook(self, speed_m_s: float, pace: Pace) -> Outlook:
        """A few seconds of computing, which count on a bench with hardware."""
        del pace
        return Outlook(0.0, speed_m_s)

    def _work(self, recording: Recording, made: Path) -> Mapping[str, bytes]:
        from hil.analysis.control_design import DesignSpec, design
        from hil.analysis.frequency_response import frf_from_csv
        from hil.core.model import load_model
        from reports.outputs.control_design import output_files

        del recording
        spec = DesignSpec(
            stabilisation=self.stabilization,
            pole_rad_s=self.pole_rad_s,
            lead_deg=self.lead_deg,
            lead_hz=self.lead_hz,
            optimise=self.optimize,
            torque_limit_nm=self.torque_limit_nm,
            name=self.name,
        )
        found = design(load_model(made / MODEL), spec)
        files = output_files(found, frf_from_csv(made / RESPONSES))
        controller = files.pop("controller.toml")
        named = {f"{self.name}_{name}": content for name, content in files.items()}
        return {str(designed_file(self.name)): controller, **named}
