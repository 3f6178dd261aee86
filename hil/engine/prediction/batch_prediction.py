"""A plan predicted again and again with other controllers and other cars, as a search wants it."""

from __future__ import annotations

import tempfile
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hil.core.controller import Controller, load_controller
from hil.core.effects import EFFECTS
from hil.core.model import Model
from hil.engine.bench.bench_file import DEFAULT_BENCH, load_bench
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.prediction._predicted_bench import PredictedBench
from hil.engine.prediction._predicted_wire import PredictedWire, wire_of
from hil.engine.prediction.prediction import PredictedRun, Prediction, predict
from hil.engine.run.preflight import Rehearsal
from hil.plant import LONGEST_STEP_S, is_stable, linear_system
from hil.plant.closed_loop import TICK_S, Noise
from test_plans import Array, Plan, Step, Work

#: Of the integrator: it leaves the acceptance plan's figures as they are to five digits, and where flanks
#: meet to half a percent of a peak.
_LONGEST_STEP_S, _WITH_A_GAP_S = 5e-4, 2.5e-4
#: A chain without rates beyond this, its torque rippling a few times a turn, needs a step a sample for that.
_CALM_RAD_S, _WHEEL, _CALM_ORDER = 150.0, "wheel_order_disturbance", 5.0
_CARS_KEPT = 24  # whose beginning is kept: 5 MB each


@dataclass
class BatchPrediction:
    """Executes `plan` on the simulated bench of `bench`, one controller in the place of `file`.

    What comes before `file` is first loaded is the same for every controller: it is predicted once for each
    car, for the last few cars. It is sent to other processes; what the bench's device files and the plan's
    controllers say is read once in each.
    """

    plan: Plan
    bench: BenchFile
    file: Path
    channels: frozenset[str]
    _here: _Here | None = field(default=None, repr=False)

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
        if self._here is None:
            self._here = _Here.of(self.plan, self.bench, self.file)
        here, tried = self._here, {} if controller is None else {self.file: controller}
        if whole:
            drawn = self._noise(noise, seed)
            return predict(self.plan, self.bench, model, controllers=tried, noise=drawn, wire=here.wire)
        runs_before, controllers = self._run_before(here, model, noise, seed), {**here.controllers, **tried}
        with tempfile.TemporaryDirectory() as folder:
            run = runs_before.continued(here.room, Path(folder), controllers)
            run.execute(here.after)
        if len(run.rows) > len(here.room):
            samples, columns = run.rows.shape
            here.room = np.zeros((samples + samples // 8, columns))  # others may take a little longer
        return run.ended()

    def _run_before(self, here: _Here, model: Model, noise: float, seed: int) -> PredictedRun:
        """A car's run as far as it is the same for every controller."""
        key = id(model), noise, seed
        if key not in here.runs_before:
            step_s = _longest_step_s(model)
            bench = PredictedBench(self.bench, model, self._noise(noise, seed), step_s, here.wire)
            run = PredictedRun(bench, Path(), self.channels, here.controllers)
            run.execute(here.before)
            here.runs_before[key] = run, model  # the model, so that no other gets its id
            if len(here.runs_before) > _CARS_KEPT:
                _, (oldest, _) = here.runs_before.popitem(last=False)
                oldest.free_rows()  # now: parts of a run hold each other, and garbage is collected seldom
        here.runs_before.move_to_end(key)
        return here.runs_before[key][0]

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
        return {**self.__dict__, "_here": None}


@dataclass
class _Here:
    """What a process knows of its trials.

    Steps `before` one loads the file that is tried, or analyses, are the same for every controller; the rest
    are `after`. `started` are runs that have executed the first of them, with their models, by car; `room`
    is for what is measured, the same for every run.
    """

    wire: PredictedWire
    controllers: Mapping[Path, Controller]
    before: tuple[Step, ...]
    after: tuple[Step, ...]
    room: Array = field(default_factory=lambda: np.zeros((0, 0)))
    runs_before: OrderedDict[tuple[int, float, int], tuple[PredictedRun, Model]] = field(
        default_factory=OrderedDict
    )

    @classmethod
    def of(cls, plan: Plan, bench: BenchFile, file: Path) -> _Here:
        walk, steps = _Loaded(bench), (*plan.steps, *plan.finally_)
        same = 0
        for step in steps:
            step.execute(walk)
            same += file not in walk.controllers and not walk.analyses
        return cls(wire_of(bench), walk.controllers, steps[:same], steps[same:])


def controller_files(plan: Plan, bench: BenchFile) -> tuple[Path, ...]:
    """The controller files that a plan loads, in order.

    Raises:
        BadInputError: the plan asks for more than the bench allows.
    """
    walk = _Loaded(bench)
    for step in (*plan.steps, *plan.finally_):
        step.execute(walk)
    return tuple(walk.controllers)


class _Loaded(Rehearsal):
    """Remembers the controllers that steps load, and whether one analyses."""

    def __init__(self, bench: BenchFile) -> None:
        super().__init__(bench)
        self.controllers: dict[Path, Controller] = {}
        self.analyses = False

    def set_controller(self, file: Path) -> None:
        """Read it, unless a step makes it."""
        super().set_controller(file)
        if file.is_absolute():
            self.controllers[file] = load_controller(file)

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        """What it makes may differ from run to run."""
        super().analyse(name, work, makes)
        self.analyses = True


def _longest_step_s(model: Model) -> float:
    """Of the integrator, for a model's fastest motion."""
    if any(use.id == "backlash" for use in model.effects):
        return _WITH_A_GAP_S if is_stable(model, _WITH_A_GAP_S) else LONGEST_STEP_S
    calm = all(
        EFFECTS[use.id].law.chain is not None
        or (use.id == _WHEEL and float(use.values["order"]) <= _CALM_ORDER)
        for use in model.effects
    )
    rates = np.abs(np.linalg.eigvals(linear_system(model).a))
    if calm and np.max(rates) <= _CALM_RAD_S:
        return TICK_S
    return _LONGEST_STEP_S if is_stable(model, _LONGEST_STEP_S) else LONGEST_STEP_S
