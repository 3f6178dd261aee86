"""The loop closed: identify, diagnose, add, tune, confirm, until run and prediction agree and nothing grows.

Every stage ends in a decision, which is kept with its reason.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hil.analysis.diagnosis import INTERRUPTED, Diagnosis
from hil.analysis.tuning import Confirmation, confirmation
from hil.app.autotune.stages import MODEL, EndedError, LoopSettings, Recorded, Stages
from hil.app.interrupts import EXIT_CODE, INTERRUPTS
from hil.app.tuning.bench_runs import WireBench
from hil.app.tuning.refinement import Refined
from hil.app.tuning.search_files import Search
from hil.core.errors import HilError
from hil.core.errors.wording import share
from hil.engine import RECORDING
from reports.outputs.autotune import Closing, Decision, Stage, effects_in_words
from reports.tuning_report import Shown


class AutotuneLoop:
    """Carries the stages out below `place`; `closing` is what is known, `keep` is called at each decision.

    `model` is the newest that a diagnosis has made, else the one that was given; `shown` are the runs whose
    responses are worth comparing.
    """

    def __init__(
        self, settings: LoopSettings, place: Path, closing: Closing, keep: Callable[[], None]
    ) -> None:
        self._settings, self.closing, self._keep = settings, closing, keep
        self._stages = Stages(settings, place)
        self._explained: list[Recorded] = []
        self.shown: list[Shown] = []
        self.model = settings.given

    def execute(self) -> int:
        """All stages; the exit code. What ended it stands in `closing`."""
        code = 0
        try:
            self._identify()
            before = self._before()
            for number in range(1, self._settings.sequence.rounds + 1):
                self._round(number, before)
            raise EndedError(f"all {self._settings.sequence.rounds} rounds are complete")
        except EndedError as ended:
            self.closing.ended, code = str(ended), ended.exit_code
        except HilError as error:  # such as recordings that cannot belong to the model
            self._settings.runs.feedback.complain(str(error))
            self.closing.ended, code = error.what, error.exit_code
        except KeyboardInterrupt:
            INTERRUPTS.answered()
            self.closing.ended, code = "interrupted", EXIT_CODE
        return code or int(not self.closing.content)

    def _identify(self) -> None:
        outcome = self._stages.run(self._settings.identify, "identify")
        self._explained.append(Recorded(outcome.folder / RECORDING))
        what = f"{len(outcome.segments)} segments recorded"
        why = "varying torque reveals effects that the model lacks"
        self._decide(0, "identify", what, "diagnose the recording", why, outcome.folder)

    def _before(self) -> Confirmation:
        """The plan that accepts as it is: what is to be bettered, and what the given model says of it."""
        trial, closing = self._settings.search.trial, self.closing
        outcome = self._stages.run(trial.plan, "before")
        found = confirmation(trial.tried({}, 0).criteria, outcome.criteria, self._settings.agree)
        closing.before_margins = trial.margins_of(outcome.criteria)
        self.shown.append(outcome.shown("before"))
        what = (
            f"worst margin {share(min(closing.before_margins.values()), 2)}; the given model is {_off(found)}"
        )
        agrees = "agrees" if found.agrees else "does not agree"
        why = f"it {agrees} within {share(found.allowed)}; recordings with excitation show what is missing"
        self._decide(0, "before", what, "diagnose", why, outcome.folder)
        return found

    def _round(self, number: int, before: Confirmation) -> None:
        folder = self._stages.place / f"round-{number}"
        search = self._better_model(number, folder / "diagnosis")
        if not self._predicts(before, number, search):
            search = self._better_model(number, folder / "diagnosis-2")
        found = self._stages.tune(search, number)
        worst = found.chosen.worst
        binds = worst.binding.replace(".", " ")
        what = f"predicted worst margin {share(worst.worst)} ({binds}); {found.runs} predictions"
        why = f"the plan's own controller has {share(found.start.worst.worst)} on this model"
        self._decide(number, "tune", what, "confirm it on the bench", why, folder / "tuned")
        refined, wire = self._stages.confirm(search, found, folder / "tuned")
        grown = self._weigh(number, refined, wire, folder / "tuned")
        if self.closing.best_round == number:
            self.closing.start_figures = found.start.nominal.figures
        self._refuse_another(refined, wire, grown=grown)

    def _better_model(self, number: int, folder: Path) -> Search:
        """What is missing in the given model: an earlier round's name may have been a wrong one."""
        found = self._stages.diagnose(self._explained, number, folder)
        self.closing.diagnosis, self.model = found, folder / MODEL
        self._judge(number, found, folder)
        return self._stages.search_on(self.model)

    def _judge(self, number: int, found: Diagnosis, folder: Path) -> None:
        what = f"verdict {found.verdict}"
        what += f": {effects_in_words(found)}" if found.effects else ""
        if found.unfinished == INTERRUPTED:
            raise EndedError.interrupted()
        if found.verdict == "unknown":
            why = found.unfinished or found.signature or "no known effect closes the gap"
            self._decide(number, "diagnose", what, "end", why, folder)
            raise EndedError(f"the diagnosis cannot identify what is missing: {why}")
        was = {name: share(found.gap_before[name].gap, 2, digits=3) for name in found.gap_after}
        gaps = ", ".join(
            f"{name} {was[name]} to {share(gap.gap, 2, digits=3)} of the signal"
            for name, gap in found.gap_after.items()
        )
        names = ", ".join(effect.use.id for effect in found.effects)
        decided = f"add {names}" if names else "keep the model with corrected parameters"
        self._decide(number, "diagnose", what, decided, f"gaps: {gaps}", folder)

    def _predicts(self, before: Confirmation, number: int, search: Search) -> bool:
        """Whether the better model predicts the plan as it was run; if not, that run is explained, too."""
        recording = Recorded(self._stages.place / "before" / RECORDING)
        measured = [one.measured for one in before.criteria]
        found = confirmation(search.trial.tried({}, 0).criteria, measured, self._settings.agree)
        enough = found.agrees or recording in self._explained
        if not enough:
            self._explained.append(recording)
        what = f"for the plan as run before, the improved model is {_off(found)}"
        decided = "tune on it" if enough else "diagnose that run, too"
        self._decide(number, "diagnose", what, decided, f"the tolerance is {share(found.allowed)}")
        return enough

    def _weigh(self, number: int, refined: Refined, wire: WireBench, folder: Path) -> bool:
        """Keep the best; whether this round's is better than those before, by as much as counts."""
        closing, best = self.closing, refined.found.best
        if best is None:
            self._decide(number, "confirm", "nothing was measured", "end", refined.found.ended, folder)
            raise (
                EndedError.interrupted()
                if refined.exit_code == EXIT_CODE
                else EndedError(refined.found.ended, refined.exit_code)
            )
        first = refined.found.runs[0].beside_prediction(self._settings.agree)
        earlier = (closing.agrees, closing.best.worst) if closing.best is not None else (False, float("-inf"))
        kept = (first.agrees, best.worst) > earlier
        if kept:
            closing.best, closing.best_round, closing.agrees = best, number, first.agrees
            self.shown[1:] = [wire.outcomes[best.number].shown("autotuned"), wire.predicted(best.controller)]
        count = len(refined.found.runs)
        what = (
            f"{count} run{'s' if count > 1 else ''}, the prediction of the first is {_off(first)}; "
            f"best measured worst margin {share(best.worst)}"
        )
        if first.agrees:
            decided, why = ("keep it" if kept else "keep the earlier one"), refined.found.ended
        else:
            last = number == self._settings.sequence.rounds
            decided = "end" if last else "diagnose that run, too"
            names = ", ".join(one.id.replace(".", " ") for one in first.beyond)
            why = f"deviation from the prediction above {share(first.allowed)}: {names}"
        self._decide(number, "confirm", what, decided, why, folder)
        return best.worst - earlier[1] >= self._settings.sequence.grow_percent / 100

    def _refuse_another(self, refined: Refined, wire: WireBench, *, grown: bool) -> None:
        """Raise where another round could bring nothing; else say what is to be explained in it."""
        found = refined.found
        if refined.exit_code == EXIT_CODE or found.ended == "stopped":
            raise EndedError.interrupted()
        if refined.exit_code or found.runs[-1].decision == "refused":
            raise EndedError(found.ended, refined.exit_code)
        agrees = found.runs[0].beside_prediction(self._settings.agree).agrees
        all_made = len(found.runs) >= self._settings.sequence.runs
        if agrees and not (all_made and grown):
            raise EndedError(f"prediction and run agree, and the margin no longer grows: {found.ended}")
        segments = self._settings.search.trial.driven.segments  # the others are as they were before
        self._explained.append(Recorded(wire.outcomes[1].folder / RECORDING, segments))

    def _decide(
        self, number: int, stage: Stage, found: str, decided: str, why: str, folder: Path | None = None
    ) -> None:
        where = "" if folder is None else str(folder.relative_to(self._stages.place))
        self.closing.decisions.append(Decision(number, stage, found, decided, why, where))
        self._keep()


def _off(found: Confirmation) -> str:
    """How far a prediction is off: the criterion that is furthest, in its unit and against its limit."""
    unknown = [one.id.replace(".", " ") for one in found.criteria if one.apart is None]
    if unknown:
        return f"different: prediction or run has no value for {', '.join(unknown)}"
    worst = max(found.criteria, key=lambda one: one.apart or 0.0, default=None)
    if worst is None or not worst.apart or worst.difference is None:
        return "exact"
    of = "its limit" if worst.of_limit else "the larger value, without a limit"
    name, by = worst.id.replace(".", " "), f"{worst.difference:+.3g} {worst.unit}".strip()
    return f"off by up to {share(worst.apart, 2)} of {of} ({name}: {by})"
