"""The stages of autotune, each in a folder with everything that its own command would have written."""

from __future__ import annotations

from collections.abc import Sequence as Several
from dataclasses import dataclass
from pathlib import Path

from hil.analysis.diagnosis import INTERRUPTED, Diagnosis, diagnose
from hil.analysis.tuning import Effort, RefinementBudget, Tuning, tune
from hil.app.diagnose import FILES as DIAGNOSIS_NAMES
from hil.app.diagnose import SUMMARY as DIAGNOSIS_SUMMARY
from hil.app.diagnose import output_files, stretches_of
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.requests import SearchRequest
from hil.app.result_file import RESULT
from hil.app.results_folder import results_in
from hil.app.run import RunSettings
from hil.app.tuning.bench_runs import FOLDER, Allowed, StageOutcome, WireBench
from hil.app.tuning.refinement import Refined, compare_first_run, refine_on
from hil.app.tuning.search_files import NAMES as TUNING_NAMES
from hil.app.tuning.search_files import SUMMARY as TUNING_SUMMARY
from hil.app.tuning.search_files import Search, load_search, write_results
from hil.core.errors import HilError
from hil.core.model import load_model
from hil.core.recording import Recording, read_recording
from hil.core.result import RunResult
from hil.engine import RECORDING, BenchFile, StopRequest
from reports.origin import origin_of
from test_plans import Plan, Sequence

MODEL = "model.toml"


class EndedError(Exception):
    """There is no further stage; the reason, and the exit code of a run that failed or of an interruption."""

    def __init__(self, reason: str, exit_code: int = 0) -> None:
        super().__init__(reason)
        self.exit_code = exit_code

    @classmethod
    def interrupted(cls) -> EndedError:
        """Somebody search."""
        return cls("interrupted", EXIT_CODE)


@dataclass(frozen=True)
class LoopSettings:
    """What the loop works with; `given` is the model that was given, `processes` predictions at once.

    With `resume` plans that were run as they are, within the same envelope, are not run again.
    """

    sequence: Sequence
    given: Path
    bench: str
    search: Search
    identify: Plan
    allowed: Allowed
    runs: RunSettings
    processes: int | None
    resume: bool = False

    @property
    def agree(self) -> float:
        """How far a run may be from its prediction, a share of a limit."""
        return self.sequence.agree_percent / 100


@dataclass(frozen=True)
class Recorded:
    """A run that is to be explained: its recording, and which of its segments (none named: all)."""

    recording: Path
    segments: tuple[str, ...] = ()

    def has(self, stretch: Recording) -> bool:
        """Whether a stretch of it is to be explained."""
        name = stretch.source.name.removeprefix(f"{self.recording.stem} ")
        return not self.segments or name in self.segments


class Stages:
    """Carries stages out below `place`.

    Raises:
        EndedError: of every stage, where there can be no other.
    """

    def __init__(self, settings: LoopSettings, place: Path) -> None:
        self._settings, self.place = settings, place
        self._spent_s, self._runs = 0.0, 0

    def run(self, plan: Plan, name: str) -> StageOutcome:
        """A plan as it is."""
        settings, folder = self._settings, self.place / name
        self._runs += 1
        bench = settings.allowed.watched(self._runs)
        made = earlier_run(plan, bench, folder) if settings.resume else None
        if made is not None:
            self._spent_s += made.bench_time_s
            return StageOutcome(folder, 0, tuple(made.segments), made.criteria)
        with settings.runs.execute(plan, bench, folder) as run:
            result, code, error = run.result, run.exit_code, run.outcome.error
        self._spent_s += result.bench_time_s
        if code == EXIT_CODE:
            raise EndedError.interrupted()
        if code > 1 or result.verdict == "error":
            reason = error.what if error else result.reason or "not all could be judged"
            raise EndedError(f"{plan.name}: {reason}", code if code > 1 else 0)
        return StageOutcome(folder, code, tuple(result.segments), result.criteria)

    def diagnose(self, runs: Several[Recorded], number: int, folder: Path) -> Diagnosis:
        """What the given model lacks to explain recordings."""
        settings, recordings = self._settings, [one.recording for one in runs]
        base, inputs = load_model(settings.given), [settings.given, *recordings]
        feedback = settings.runs.feedback
        claim = results_in(
            folder,
            DIAGNOSIS_NAMES,
            inputs=inputs,
            overwrite=settings.runs.overwrite,
            summary=DIAGNOSIS_SUMMARY,
        )
        with claim as place, feedback.progress(f"round {number}: diagnosis") as show:
            found = diagnose(
                base,
                [
                    part
                    for one in runs
                    for part in stretches_of([one.recording], base, feedback, show)
                    if one.has(part)
                ],
                at_most_s=60.0 * settings.sequence.diagnose_minutes,
                show=show,
            )
            if found.unfinished == INTERRUPTED:
                INTERRUPTS.answered()
            show("writing the report")
            origin = origin_of({"model": [settings.given], "recording": recordings})
            place.write(output_files(found, settings.given.name, origin), inputs)
        return found

    def search_on(self, model: Path) -> Search:
        """The plan that accepts, predicted on a model, within what was consented to."""
        found = search_for(self._settings.sequence, model, self._settings.bench)
        return found.within(self._settings.allowed.envelope)

    def tune(self, search: Search, number: int) -> Tuning:
        """Search on the model; an interrupt ends it, for nothing of it was measured."""
        settings = self._settings
        with settings.runs.feedback.progress(f"round {number}: tune") as show:
            return tune(
                search.trial,
                seed=settings.sequence.seed,
                effort=Effort(starts=settings.sequence.starts),
                processes=settings.processes,
                show=lambda text, share: show(text, share),
            )

    def confirm(self, search: Search, found: Tuning, folder: Path) -> tuple[Refined, WireBench]:
        """Run what was found, and refine it unless the first run is not as predicted."""
        settings, sequence, stop = self._settings, self._settings.sequence, StopRequest()
        budget = RefinementBudget(sequence.runs, sequence.grow_percent / 100, settings.agree)
        claim = results_in(
            folder,
            TUNING_NAMES,
            inputs=(*settings.runs.inputs, *search.inputs),
            overwrite=settings.runs.overwrite,
            summary=TUNING_SUMMARY,
        )
        with claim as place, stop.by_signals():
            wire = WireBench(
                sequence.accept_plan,
                search.trial,
                search.trial.draws[0].model,
                settings.allowed,
                settings.runs,
                folder / FOLDER,
            )
            wire.bench_time_s, wire.earlier_runs = self._spent_s, self._runs
            refined = refine_on(
                wire, found, budget, settings.processes, settings.runs.feedback, lambda: stop.times > 0
            )
            self._spent_s, self._runs = wire.bench_time_s, self._runs + len(wire.outcomes)
            first = compare_first_run(refined, settings.agree, lambda: "")  # the next round diagnoses it
            write_results(search, found, place.write, refined, first)
        return refined, wire


def earlier_run(plan: Plan, bench: BenchFile, folder: Path) -> RunResult | None:
    """The result of a whole run of this very plan on this very bench file in a folder, if there is one."""
    try:
        result = RunResult.model_validate_json((folder / RESULT).read_text("utf-8"))
        recording = read_recording(folder / RECORDING, least_samples=0, allow_missing=True)
    except (OSError, ValueError, HilError):
        return None
    same = (("plan.yaml", plan.text), ("bench.toml", bench.text))
    if any(recording.attachments.get(name) != text.encode() for name, text in same):
        return None
    return None if result.verdict == "error" or result.safe_state == "not_confirmed" else result


def search_for(sequence: Sequence, model: Path, bench: str) -> Search:
    """What a sequence has tuned, on a model.

    Raises:
        BadInputError: plan, controller, what is free, model or bench cannot be used.
    """
    return load_search(
        SearchRequest(
            plan=sequence.accept_plan,
            model=model,
            bench=bench,
            free=sequence.free_file,
            controller=sequence.controller,
            draws=sequence.draws,
            seed=sequence.seed,
        )
    )
