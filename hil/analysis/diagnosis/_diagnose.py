"""The diagnosis as a whole: check the data, find, name, judge on held-out data, tell."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis._asked import Asked
from hil.analysis.diagnosis.by_likelihood import diagnosis_of
from hil.analysis.diagnosis.data.grid import coarse_noise, grids
from hil.analysis.diagnosis.data.noise import cancelling, rising, stated_noise
from hil.analysis.diagnosis.data.sanity import Examined, examined
from hil.analysis.diagnosis.data.trace import Trace
from hil.analysis.diagnosis.fit.allowance import UNBOUNDED, Allowance, OutOfTimeError
from hil.analysis.diagnosis.fit.between_samples import likelier_requests
from hil.analysis.diagnosis.fit.coordinates import Hypothesis, undetermined
from hil.analysis.diagnosis.fit.fit import fit, polished
from hil.analysis.diagnosis.fit.problem import Problem, problem_of
from hil.analysis.diagnosis.fit.reweighted import reweighted
from hil.analysis.diagnosis.search.by_chance import most_by_chance
from hil.analysis.diagnosis.search.evidence import Evidence
from hil.analysis.diagnosis.search.from_base import search_from_base
from hil.analysis.diagnosis.search.hopping import hopped
from hil.analysis.diagnosis.search.predictable import counted_after_all, left_out
from hil.analysis.diagnosis.search.search import Found, begin_search, search, so_far
from hil.analysis.diagnosis.search.wandering import with_wandering
from hil.analysis.diagnosis.tell.confidence import Sure, drop_of
from hil.analysis.diagnosis.tell.judged import Judged
from hil.analysis.diagnosis.tell.result import INTERRUPTED, OUT_OF_TIME, Alternative, Diagnosis, Verdict
from hil.analysis.diagnosis.tell.verdict import verdict_of
from hil.analysis.missing_effects import explain_gap
from hil.analysis.plausible import refuse_same_data, within_floating_point
from hil.core.effects import EFFECTS
from hil.core.model import EffectUse, Model
from hil.core.recording import Recording
from hil.plant import gear_ratio_of, refuse_motor_limits
from hil.plant.sides import refuse_separate

Array = npt.NDArray[np.float64]

ASK_FOR_CHAIN = (
    "transfer functions have no parts: what is missing inside the axle (play, friction, a mount, a tyre) "
    "cannot be added to them, nor can one of their numbers be corrected. Get the chain: 'hil run "
    "identification', then 'hil identify' on its recording writes physical.toml: give that as --model"
)


def diagnose(
    model: Model,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording] = (),
    *,
    noise: Mapping[str, float] | None = None,
    least: Mapping[str, float] | None = None,
    at_most_s: float = math.inf,
    show: Callable[[str], None] = lambda text: None,
) -> Diagnosis:
    """Say which effects `model` lacks to explain `recordings`, and by how much they close the gap.

    Args:
        model: a chain; or transfer functions, to which only effects of torque path and sensors can be added.
        holdout: recordings that no fit sees, only the final figures.
        noise: standard deviation of a sample that a channel's sensor is known to have, by channel; before
            what the recordings' bench files state.
        least: smallest size of an effect that is worth a name, by effect; others have sizes of their own.
        at_most_s: processor time of the search, s; what it knows by then is stated as `unfinished`.
        show: stated what is going on.

    An interrupt (KeyboardInterrupt) ends the search likewise; before anything is known, and while it is
    stated, it is raised.

    Raises:
        BadInputError: the recordings cannot belong to the model (inverted, swapped, dead, clipped, wrong
            gear ratio, values that no axle gives), hold the same data twice, or have no output of the model.
    """
    refuse_separate(model, "a diagnosis")
    refuse_motor_limits(model, "a diagnosis")
    refuse_same_data(recordings, holdout)
    stated = stated_noise([*recordings, *holdout])
    asked = Asked.checked({**stated, **(noise or {})}, least or {}, at_most_s)
    with within_floating_point(", ".join(str(r.source) for r in recordings)):
        ends_s = time.process_time() + asked.at_most_s
        found, notes = _diagnosed(model, recordings, holdout, asked, show)
        if model.transfer_functions or found.unfinished or not leaves_more_than_noise(found):
            return found
        return _judged_again(found, notes, model, recordings, holdout, asked, show, ends_s)


def leaves_more_than_noise(found: Diagnosis) -> bool:
    """Whether what was found is no explanation to the noise: its names are then no more than candidates."""
    return bool(found.verdict == "unknown" or found.open_channels or found.held_out_open)


def _judged_again(
    found: Diagnosis,
    notes: Sequence[str],
    model: Model,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    asked: Asked,
    show: Callable[[str], None],
    ends_s: float,
) -> Diagnosis:
    """What one likelihood, in which a misfit counts with its own correlation, says of the same recordings.

    The search judges a name by how much of the base's gap it closes, which far from the noise is true of
    whatever brakes a base that runs away (docs/decisions/0031). Without a name of the likelihood's own an
    `unknown` stays what it is.

    Args:
        ends_s: processor time at which the search and this together have taken what they may.
    """

    def show_in_time(text: str) -> None:
        if time.process_time() > ends_s:
            raise OutOfTimeError
        show(text)

    try:
        outcome = explain_gap(model, recordings, holdout, noise=asked.noise, show=show_in_time)
        other = diagnosis_of(outcome, model, least=asked.least, considered=found.considered, notes=notes)
    except KeyboardInterrupt:
        return _unfinished(found, INTERRUPTED)
    except OutOfTimeError:
        return _unfinished(found, _time_is_up(asked))
    if other.verdict == "named" or found.verdict == "named":
        return replace(other, seconds=found.seconds + other.seconds)
    return replace(found, seconds=found.seconds + other.seconds)


def _unfinished(found: Diagnosis, why: str) -> Diagnosis:
    """What the search found, its names no more than candidates: nothing has judged them yet."""
    candidates = tuple(
        Alternative(one.use, one.confidence, EFFECTS[one.use.id].shown_by) for one in found.effects
    )
    return replace(
        found,
        verdict="unknown",
        effects=(),
        alternatives=(*candidates, *found.alternatives),
        unfinished=why,
    )


def _time_is_up(asked: Asked) -> str:
    return f"{asked.at_most_s / 60.0:.3g} min of processor time were up (--at-most)"


def _diagnosed(
    model: Model,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    asked: Asked,
    show: Callable[[str], None],
) -> tuple[Diagnosis, list[str]]:
    """What the search finds, and notes on the data."""
    began = time.perf_counter()
    show("reading the noise")
    base, problem, held, rounded, on_data = _made_ready(model, recordings, holdout, asked)
    notes = [*on_data]
    found, unfinished = _searched(problem, base, rounded, show)
    problem.allowance.lift()
    if unfinished == OUT_OF_TIME:
        unfinished = _time_is_up(asked)
    problem = replace(problem, traces=found.evidence.problem.traces, angles=found.best.angles)
    show("judging")
    verdict: Verdict = "unknown" if unfinished else verdict_of(found, bool(rounded))
    by_chance = None
    if verdict == "named" and found.best.hypothesis.terms:
        by_chance = most_by_chance(problem, found.best)
        if min(drop_of(found, index) for index in range(len(found.best.hypothesis.terms))) <= by_chance:
            verdict = "none" if found.evidence.closed(found.base) else "unknown"
    sure = Sure.of(found) if verdict == "named" else None
    if verdict == "named":
        problem = _with_care(problem, found)
    notes += left_out(problem)
    if problem.functions and verdict == "unknown":
        notes.append(ASK_FOR_CHAIN)
    judged = Judged(problem, found, verdict, held, by_chance, asked.least, unfinished, sure)
    return judged.diagnosis(rounded, notes, time.perf_counter() - began), on_data


def _with_care(problem: Problem, found: Found) -> Problem:
    """What is named in `found` fitted to its end, to all that it predicts; where errors count then."""
    if problem.partial:
        problem, found.best = counted_after_all(problem, found.base, found.best)
        found.evidence = Evidence(problem, found.base, found.evidence.rounding)
    found.best = hopped(problem, found.best)
    found.best = with_wandering(problem, reweighted(problem, polished(problem, found.best)))
    return problem


def _made_ready(
    model: Model, recordings: Sequence[Recording], holdout: Sequence[Recording], asked: Asked
) -> tuple[Hypothesis, Problem, Examined, list[EffectUse], list[str]]:
    """The base model, what is to be fitted and what is held out, roundings of channels, notes on the data."""
    seen = examined(model, recordings)
    held = examined(model, holdout, seen.traces)
    base = Hypothesis(model, held=undetermined(seen.traces))
    rounded = grids(seen.traces, seen.noise)
    means = cancelling(seen.traces, seen.noise)
    noise = rising(seen.traces, means, seen.noise)

    weighed = np.where(np.isfinite(means), means, coarse_noise(noise, rounded))

    def problem_with(traces: Sequence[Trace], unsure: float | Array = 0.0) -> Problem:
        return problem_of(
            traces,
            np.hypot(weighed, unsure),
            gear_ratio_of(model) or 1.0,
            floor=np.hypot(noise, unsure),
            stated=asked.noise,
            allowance=Allowance(asked.at_most_s),
            functions=model.transfer_functions,
        )

    taken, unseen = (
        likelier_requests(t, base, lambda trace: problem_with([trace])) for t in (seen.traces, held.traces)
    )
    level = np.hypot(np.where(np.isfinite(means), noise, held.noise), unseen.unsure)
    held = replace(held, traces=unseen.traces, noise=level)
    notes = [f"{t.name}: {n}" for t in taken.traces for n in t.notes] + seen.notes + taken.notes
    return base, problem_with(taken.traces, taken.unsure), held, rounded, notes


def _searched(
    problem: Problem, hypothesis: Hypothesis, rounded: list[EffectUse], show: Callable[[str], None]
) -> tuple[Found, str]:
    """What is found, and why the search ended before it was through, if it did."""
    known: list[Found] = []
    try:
        # functions have no numbers that could be identified anew
        searching = search if problem.functions else search_from_base
        return searching(problem, hypothesis, show, rounded, known), ""
    except KeyboardInterrupt:
        if not known:
            raise
        return so_far(known), INTERRUPTED
    except OutOfTimeError:
        if not known:  # nothing was fitted yet: the model as it came
            free = replace(problem, allowance=UNBOUNDED)
            known.append(begin_search(free, fit(free, hypothesis, rounds=0), rounded))
        return so_far(known), OUT_OF_TIME
