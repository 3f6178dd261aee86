"""Which conditions a guess holds, and by how much: the whole plan, and a real identification run."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hil.analysis.frequency_response import experiments_of
from hil.analysis.identification import identify
from hil.analysis.target_search._targets import ResponseTarget, Targets
from hil.analysis.target_search._trial import (
    BAND_HZ,
    SETTLED_SHARE,
    SETTLED_UNTIL_S,
    Guess,
    Outcome,
    Trial,
    rms_misfit,
)
from hil.core.channels import OUTPUTS
from hil.core.errors import HilError
from hil.core.recording import RUN
from hil.core.result import RunResult

_FREQUENCIES = 400


@dataclass(frozen=True)
class Condition:
    """One thing that must hold: what was found, in `unit`, what is allowed, and whether it holds.

    `identified` if an identification run tells it.
    """

    name: str
    found: float | None
    limit: str
    unit: str
    holds: bool
    identified: bool = False


def conditions_of(guess: Guess, outcome: Outcome, trial: Trial) -> tuple[Condition, ...]:
    """Every condition of the targets, judged on the whole plan and on an identification run."""
    targets = trial.targets
    found = [*_figures(outcome, targets), *_orderings(outcome), *_settling(outcome, targets)]
    if targets.response is not None:
        found += _response(guess, trial, targets.response)
    return tuple(found)


def _figures(outcome: Outcome, targets: Targets) -> Iterator[Condition]:
    units = {c.id: c.metric.unit for c in targets.plan.criteria}
    seconds = targets.first_seconds
    for name, wanted in targets.values.items():
        limit = f"{wanted:g} ± {100 * targets.tolerance:g} %"
        yield _near(name, outcome.figures[name], wanted, targets.tolerance, limit, units[name])
        if seconds is not None:
            early = outcome.early[name]
            yield _near(f"{name}, first {seconds:g} s", early, wanted, targets.tolerance, limit, units[name])


def _near(
    name: str, found: float | None, wanted: float, tolerance: float, limit: str, unit: str
) -> Condition:
    holds = found is not None and abs(found / wanted - 1.0) <= tolerance
    return Condition(name, found, limit, unit, holds)


def _orderings(outcome: Outcome) -> Iterator[Condition]:
    for name, ratio in outcome.ratios.items():
        yield Condition(name, ratio, "< 1", "ratio", ratio is not None and ratio < 1.0)


def _settling(outcome: Outcome, targets: Targets) -> Iterator[Condition]:
    for segment, after_s in targets.settles.items():
        found = outcome.unsettled.get(segment)
        percent = None if found is None else 100.0 * found
        yield Condition(
            f"{segment}: T_s around its mean from {after_s:g} to {SETTLED_UNTIL_S:g} s",
            percent,
            f"≤ {100 * SETTLED_SHARE:g}",
            "% of the step",
            found is not None and found <= SETTLED_SHARE,
        )


def _response(guess: Guess, trial: Trial, wanted: ResponseTarget) -> Iterator[Condition]:
    """What `hil identify` finds on this bench, against the functions that a real one gave."""
    frequency = np.geomspace(*BAND_HZ, _FREQUENCIES)
    try:
        found = trial.run(wanted.plan, guess)
        run = RunResult(
            verdict="pass",
            plan=wanted.plan.name,
            bench="prediction",
            real_time_factor=0.0,
            bench_time_s=0.0,
            safe_state="not_needed",
            segments=found.segments,
        )
        attachments = {**found.recording.attachments, RUN: run.model_dump_json().encode()}
        recording = dataclasses.replace(found.recording, attachments=attachments)
        modes = identify(experiments_of(recording, segments=wanted.segments)).fit.modes
        response = modes.response(frequency)
    except HilError:
        response = None
    for name, (most_db, most_deg) in wanted.within.items():
        misfit: tuple[float | None, float | None] = (None, None)
        if response is not None:
            misfit = rms_misfit(response[OUTPUTS.index(name)], wanted.functions, name, frequency)
        for value, most, unit in zip(misfit, (most_db, most_deg), ("dB", "°"), strict=True):
            holds = value is not None and value <= most
            yield Condition(f"identified response of {name}", value, f"≤ {most:g}", unit, holds, True)
