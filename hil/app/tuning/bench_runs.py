"""Tuned controllers measured on a bench, within an envelope that somebody has consented to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from hil.analysis.tuning import Measured, RefinementBudget, Trial
from hil.app.consent import consent, refuse_nobody
from hil.app.feedback import Feedback
from hil.app.run import RunSettings
from hil.core.controller import Controller, controller_to_toml
from hil.core.files import make_directory, write_atomically
from hil.core.model import Model
from hil.core.recording import read_recording
from hil.core.result import CriterionResult, Segment
from hil.engine import RECORDING, BenchFile
from hil.engine.bench.bench_file import with_seed
from hil.engine.prediction.batch_prediction import BatchPrediction
from hil.engine.prediction.forecast import Envelope, envelope_of
from hil.engine.prediction.prediction import Prediction
from reports.tuning_report import Shown
from test_plans import Choices, load_plan

FOLDER = "bench"


@dataclass(frozen=True)
class Allowed:
    """A bench, what may be done on it, and who consented."""

    bench: BenchFile
    envelope: Envelope
    name: str

    def watched(self, run: int) -> BenchFile:
        """The bench with the envelope among its limits; a simulated one has noise of its own in each run."""
        simulation = self.bench.simulation
        bench = self.bench if simulation is None else with_seed(self.bench, simulation.seed + run)
        return self.envelope.watched_on(bench)

    def answered(self, settings: RunSettings) -> RunSettings:
        """Runs for which it was answered beforehand, prompts and hazards included."""
        name = self.name
        if not name:
            return settings
        return replace(settings, confirmed_by=name, hazard_confirmed_by=name)

    def in_words(self) -> str:
        """To what somebody consented, and who."""
        by = (
            f"{self.name} consented to"
            if self.name
            else "The bench is simulated, no consent is needed; allowed:"
        )
        return f"{by} {self.envelope.in_words()}."

    def as_json(self) -> dict[str, Any]:
        """Bench, consent and envelope."""
        envelope = self.envelope
        stated = {
            "largest": dict(envelope.largest),
            "runs": envelope.runs,
            "bench_time_s": envelope.bench_time_s,
        }
        return {"bench": self.bench.name, "consent": self.name, "envelope": stated}


def allowed_on(
    bench: BenchFile,
    trial: Trial,
    model: Model,
    runs: int | None,
    largest: Mapping[str, float],
    confirm: str,
    feedback: Feedback,
) -> Allowed:
    """Predict the plan as it is, draw an envelope around it, and have somebody consent to that.

    Args:
        runs: at most so many; None for the default.
        largest: magnitudes that are allowed, by channel, in place of those that are drawn.
        confirm: name of who consents; '' if the person at the terminal is asked.

    Raises:
        BadInputError: the envelope makes no sense or leaves no room, or no one consents.
    """
    refuse_nobody(trial.plan, bench, confirm, feedback)
    predicted = predicted_run(trial, model, None)
    lasts_s = float(predicted.recording.time_s[-1])
    envelope = envelope_of(bench, predicted.peaks, runs or RefinementBudget.runs, lasts_s, dict(largest))
    return Allowed(bench, envelope, consent((trial.plan,), bench, envelope, confirm, feedback))


@dataclass(frozen=True)
class StageOutcome:
    """A run that was made: where it is, and the exit code that it alone would have had."""

    folder: Path
    exit_code: int
    segments: tuple[Segment, ...]
    criteria: tuple[CriterionResult, ...]

    def shown(self, name: str) -> Shown:
        """It as one of the compared responses."""
        recording = read_recording(self.folder / RECORDING, least_samples=0, allow_missing=True)
        return Shown(name, recording, self.segments)


class WireBench:
    """A plan on a bench, each run in a folder of its own below `place`.

    `bench_time_s` and `earlier_runs` count from what was done on the bench before.

    Args:
        plan: as the command was given it.
        trial: what is tuned; it predicts runs.
        model: of the axle, for these predictions.
        allowed: the bench; the envelope is watched on it beside its own limits.
        settings: whether results are replaced, and what must not be.
    """

    def __init__(
        self,
        plan: str,
        trial: Trial,
        model: Model,
        allowed: Allowed,
        settings: RunSettings,
        place: Path,
    ) -> None:
        self._plan, self._name = plan, name_in(plan, trial.driven.file)
        self._trial, self._model = trial, model
        self.allowed, self._envelope, self._place = allowed, allowed.envelope, place
        self._settings = allowed.answered(settings)
        self.outcomes: dict[int, StageOutcome] = {}
        self.bench_time_s, self.earlier_runs = 0.0, 0

    def refused(self, controller: Controller) -> str:
        """Why a run with it would leave the envelope; '' if it would not."""
        predicted = predicted_run(self._trial, self._model, controller)
        beyond = self._envelope.beyond(predicted.peaks)
        if beyond:
            return f"the run would leave the envelope: {beyond}"
        lasts_s = float(predicted.recording.time_s[-1])
        if self.bench_time_s + lasts_s > self._envelope.bench_time_s:
            left = self._envelope.bench_time_s - self.bench_time_s
            return f"the envelope has {left:.0f} s left, a run takes {lasts_s:.0f} s"
        return ""

    def run(self, controller: Controller, number: int) -> Measured:
        """Carry the plan out with it."""
        folder = self._place / f"{number:02d}"
        make_directory(self._place)
        file = self._place / f"{number:02d}.toml"
        write_atomically(file, controller_to_toml(controller))
        plan = load_plan(self._plan, Choices({self._name: file}))
        bench = self.allowed.watched(self.earlier_runs + number)
        with self._settings.execute(plan, bench, folder) as run:
            result = run.result
            self.outcomes[number] = StageOutcome(
                folder, run.exit_code, tuple(result.segments), result.criteria
            )
            error = run.outcome.error
        self.bench_time_s += result.bench_time_s
        if error is not None or result.safe_state == "not_confirmed":
            return Measured((), error.what if error else "the safe state is not confirmed")
        return Measured(result.criteria)

    def predicted(self, controller: Controller) -> Shown:
        """A whole run with it as the model has it, as one of the compared responses."""
        found = predicted_run(self._trial, self._model, controller)
        return Shown("predicted", found.recording, found.segments)

    @property
    def exit_code(self) -> int:
        """The largest of runs that failed or were interrupted; 0 if none was."""
        return max((one.exit_code for one in self.outcomes.values() if one.exit_code > 1), default=0)


def predicted_run(trial: Trial, model: Model, controller: Controller | None) -> Prediction:
    """A whole run of the trial's plan, with every channel and its peaks; None: the plan's own controller."""
    assert isinstance(trial.execute, BatchPrediction)
    return trial.execute(model, controller, 0.0, 0, whole=True)


def name_in(plan: str, file: Path) -> str:
    """What a plan calls a controller file."""
    text = load_plan(plan).text
    return next((name for name in (str(file), file.name) if name in text), file.name)
