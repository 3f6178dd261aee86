"""The stages of `hil autotune`, each in a folder with everything that its own command would have written."""

from __future__ import annotations

from collections.abc import Sequence as Several
from dataclasses import dataclass
from pathlib import Path

from hil.analysis.diagnosis import INTERRUPTED, Diagnosis, diagnose
from hil.analysis.tuning import Effort, Patience, Tuning, tune
from hil.cli._interrupts import EXIT_CODE, INTERRUPTS
from hil.cli._on_bench import FOLDER, Allowed, Carried, WireBench
from hil.cli._one_run import Runs
from hil.cli._output import progress
from hil.cli._place import results_in
from hil.cli._refine_on_bench import Refined, refined
from hil.cli._tuning import NAMES as TUNING_NAMES
from hil.cli._tuning import SUMMARY as TUNING_SUMMARY
from hil.cli._tuning import Asked, asked_of, write_results
from hil.cli.diagnose import FILES as DIAGNOSIS_NAMES
from hil.cli.diagnose import output_files, stretches_of
from hil.core.model import load_model
from hil.engine import StopRequest
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
        """Somebody asked."""
        return cls("interrupted", EXIT_CODE)


@dataclass(frozen=True)
class Told:
    """What the loop is told; `given` is the model that was given, `processes` predictions at once."""

    sequence: Sequence
    given: Path
    bench: str
    asked: Asked
    identify: Plan
    allowed: Allowed
    runs: Runs
    processes: int | None

    @property
    def agree(self) -> float:
        """How far a run may be from its prediction, a share of a limit."""
        return self.sequence.agree_percent / 100


class Stages:
    """Carries stages out below `place`.

    Raises:
        EndedError: of every stage, where there can be no other.
    """

    def __init__(self, told: Told, place: Path) -> None:
        self._told, self.place = told, place
        self._spent_s = 0.0

    def run(self, plan: Plan, name: str) -> Carried:
        """A plan as it is."""
        told, folder = self._told, self.place / name
        with told.runs.finished(plan, told.allowed.watched, folder) as run:
            result, code, error = run.result, run.exit_code, run.outcome.error
        self._spent_s += result.bench_time_s
        if code == EXIT_CODE:
            raise EndedError.interrupted()
        if code > 1 or result.verdict == "error":
            reason = error.what if error else result.reason or "not all could be judged"
            raise EndedError(f"{plan.name}: {reason}", code if code > 1 else 0)
        return Carried(folder, code, tuple(result.segments), result.criteria)

    def diagnose(self, recordings: Several[Path], number: int, folder: Path) -> Diagnosis:
        """What the given model lacks to explain recordings."""
        told = self._told
        base, inputs = load_model(told.given), [told.given, *recordings]
        claim = results_in(
            folder, DIAGNOSIS_NAMES, inputs=inputs, overwrite=told.runs.overwrite, summary="diagnosis.json"
        )
        with claim as place, progress(f"round {number}: diagnosis") as show:
            found = diagnose(
                base,
                stretches_of(list(recordings), base, show),
                at_most_s=60.0 * told.sequence.diagnose_minutes,
                show=show,
            )
            if found.unfinished == INTERRUPTED:
                INTERRUPTS.answered()
            show("writing the report")
            origin = origin_of({"model": [told.given], "recording": list(recordings)})
            place.write(output_files(found, told.given.name, origin), inputs)
        return found

    def asked_on(self, model: Path) -> Asked:
        """The plan that accepts, predicted on a model."""
        return asked_for(self._told.sequence, model, self._told.bench)

    def tune(self, asked: Asked, number: int) -> Tuning:
        """Search on the model."""
        told, stop = self._told, StopRequest()
        with progress(f"round {number}: tune") as show, stop.by_signals():
            found = tune(
                asked.trial,
                seed=told.sequence.seed,
                effort=Effort(starts=told.sequence.starts),
                processes=told.processes,
                show=lambda text, share: show(text, share),
                stopped=lambda: stop.times > 0,
            )
        if stop.times:
            raise EndedError.interrupted()
        return found

    def confirm(self, asked: Asked, found: Tuning, folder: Path) -> tuple[Refined, WireBench]:
        """Run what was found, and refine it unless the first run is not as predicted."""
        told, sequence, stop = self._told, self._told.sequence, StopRequest()
        patience = Patience(sequence.runs, sequence.grow_percent / 100, told.agree)
        claim = results_in(
            folder,
            TUNING_NAMES,
            inputs=(*told.runs.inputs, *asked.inputs),
            overwrite=told.runs.overwrite,
            summary=TUNING_SUMMARY,
        )
        with claim as place, stop.by_signals():
            wire = WireBench(
                sequence.accept_plan,
                asked.trial,
                asked.trial.draws[0].model,
                told.allowed,
                told.runs,
                folder / FOLDER,
            )
            wire.bench_time_s = self._spent_s
            came = refined(found, wire, patience, told.processes, lambda: stop.times > 0)
            self._spent_s = wire.bench_time_s
            write_results(asked, found, place.write, refinement=came)
        return came, wire


def asked_for(sequence: Sequence, model: Path, bench: str) -> Asked:
    """What a sequence has tuned, on a model.

    Raises:
        BadInputError: plan, controller, what is free, model or bench cannot be used.
    """
    return asked_of(
        sequence.accept_plan,
        model,
        sequence.free_file,
        sequence.controller,
        None,
        sequence.draws,
        sequence.seed,
        bench,
    )
