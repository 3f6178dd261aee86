"""A plan predicted again and again with other controllers and other cars, as a search wants it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from hil.core.controller import Controller
from hil.core.model import Model
from hil.engine._predicted_wire import PredictedWire, wire_of
from hil.engine.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench_tables import BenchFile
from hil.engine.prediction import Prediction, predict
from hil.plant import LONGEST_STEP_S
from hil.plant.closed_loop import Noise
from test_plans import Plan

#: Of the integrator: it leaves the acceptance plan's figures as they are to five digits, and where flanks
#: meet to half a percent of a peak.
_LONGEST_STEP_S, _WITH_A_GAP_S = 5e-4, 2.5e-4


@dataclass
class TrialRuns:
    """Carries `plan` out on the simulated bench of `bench`, one controller in the place of `file`.

    It is sent to other processes; what the bench's device files say is read once in each.
    """

    plan: Plan
    bench: BenchFile
    file: Path
    channels: frozenset[str]
    _wire: PredictedWire | None = field(default=None, repr=False)

    def __call__(
        self, model: Model, controller: Controller | None, noise: float, seed: int, *, whole: bool = False
    ) -> Prediction:
        """Predict the run.

        Args:
            controller: in place of the plan's file; None: the file itself.
            noise: of the sensors, times what the bench file states.
            seed: of the noise.
            whole: every channel, and the integrator's step as on the wire.

        Raises:
            HilError: the run would fail.
        """
        if self._wire is None:
            self._wire = wire_of(self.bench)
        return predict(
            self.plan,
            self.bench,
            model,
            controllers={} if controller is None else {self.file: controller},
            noise=self._noise(noise, seed),
            channels=None if whole else self.channels,
            longest_step_s=LONGEST_STEP_S if whole else _longest_step_s(model),
            wire=self._wire,
        )

    def _noise(self, times: float, seed: int) -> Noise | None:
        """As the bench file states it; a bench of hardware is taken for as noisy as the shipped one."""
        if not times:
            return None
        simulation = self.bench.simulation or load_bench(DEFAULT_BENCH).simulation
        assert simulation is not None, "the default bench is simulated"
        stated = simulation.noise
        return Noise(
            times * stated.motor_speed_rad_s,
            times * stated.wheel_speed_rad_s,
            times * stated.shaft_torque_nm,
            seed,
        )

    def __getstate__(self) -> Mapping[str, object]:
        return {**self.__dict__, "_wire": None}


def _longest_step_s(model: Model) -> float:
    return _WITH_A_GAP_S if any(use.id == "backlash" for use in model.effects) else _LONGEST_STEP_S
