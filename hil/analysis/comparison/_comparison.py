"""Criteria of several runs side by side, and how far the responses of each are from the first run's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.comparison._runs import ComparedRun, controllers_that_differ
from hil.core.channels import TIME
from hil.core.errors import BadInputError
from hil.core.result import CriterionResult, CriterionVerdict, Segment

Array = npt.NDArray[np.float64]
Response = tuple[Array, Array]  # time from the step in s, values

_LEAST_SAMPLES = 2
_TREND = 3  # order of what changes slowly behind a step, as drag that grows with speed does
CHANNELS = ("shaft_torque_nm", "motor_speed_rad_s", "wheel_speed_rad_s")


@dataclass(frozen=True)
class CriterionRow:
    """One criterion of every run, in the criterion's unit; a value of None has a verdict that says why.

    A run of another plan that has no such criterion has neither value nor verdict.
    """

    id: str
    title: str
    unit: str
    values: tuple[float | None, ...]
    verdicts: tuple[CriterionVerdict | None, ...]
    limit: str
    absolute: bool

    @property
    def relative(self) -> tuple[float | None, ...]:
        """(value - first run's) / |first run's|; None where either is missing or the first is zero."""
        first = self.values[0]
        return tuple(
            None if value is None or not first else (value - first) / abs(first) for value in self.values
        )


@dataclass(frozen=True)
class ResponseRow:
    """One channel of one segment: rms(run - first run) / rms(first run - its mean), by run; 0 for the first.

    `ripples` over the same: the rms that two steady ripples in antiphase would have, those of the first run
    and of the run. A gap below that proves no difference: equal controllers reach it where the wheels stood
    elsewhere at the step. NaN where a run lacks the channel or the segment, or the segment is no step.
    """

    segment: str
    channel: str
    gaps: tuple[float, ...]
    ripples: tuple[float, ...]

    def within_ripple(self, run: int) -> bool:
        """Whether ripple out of phase alone could make the gap of a run."""
        return self.gaps[run] <= self.ripples[run]


@dataclass(frozen=True)
class Comparison:
    """Runs of one plan, or of several; everything is reported against the first."""

    runs: tuple[ComparedRun, ...]
    criteria: tuple[CriterionRow, ...]
    responses: tuple[ResponseRow, ...]
    notes: tuple[str, ...]

    @property
    def distances(self) -> tuple[float | None, ...]:
        """By run: mean of |relative difference| over the criteria that have a value in every run.

        Criteria relative to another segment repeat a value and do not count. None where none is left.
        """
        rows = [row.relative for row in self.criteria if row.absolute]
        whole = [row for row in rows if all(value is not None for value in row)]
        if not whole:
            return (None,) * len(self.runs)
        return tuple(
            float(np.mean(np.abs(np.array(whole, dtype=float)[:, i]))) for i in range(len(self.runs))
        )


def compare(runs: Sequence[ComparedRun]) -> Comparison:
    """Lay runs side by side: of one plan, or of plans that have anything in common.

    Segments are matched by name and kind, criteria by id and unit.

    Raises:
        BadInputError: fewer than two runs, or no common channel.
    """
    if len(runs) < 2:
        raise BadInputError("one run cannot be compared", fix="name at least two run directories")
    _refuse_without_common_channel(runs)
    notes = []
    changed = controllers_that_differ(runs)
    if changed:
        notes.append(f"Controllers differ between the runs: {', '.join(changed)}.")
    notes += [f"{run.name}: {sentence}." for run in runs for sentence in run.recording.damage]
    notes += [f"{run.name}: {_first_line(run.result.reason)}" for run in runs if run.result.reason]
    return Comparison(tuple(runs), _criteria(runs), _responses(runs), tuple(notes))


def _first_line(text: str) -> str:
    return text.splitlines()[0]


def _refuse_without_common_channel(runs: Sequence[ComparedRun]) -> None:
    first = runs[0]
    for run in runs[1:]:
        if not any(name != TIME and name in run.recording for name in first.recording.channels):
            raise BadInputError(
                f"has no channel in common with {first.recording.source}",
                where=str(run.recording.source),
                fix="compare runs that measured the same channel",
            )


def _criteria(runs: Sequence[ComparedRun]) -> tuple[CriterionRow, ...]:
    """Of all runs: those of the first in its order, then those that it has not."""
    tables = [{(one.id, one.unit): one for one in run.result.criteria} for run in runs]
    known = {key: one for table in reversed(tables) for key, one in table.items()}
    return tuple(
        CriterionRow(
            known[key].id,
            known[key].title,
            known[key].unit,
            tuple(table[key].value if key in table else None for table in tables),
            tuple(table[key].verdict if key in table else None for table in tables),
            _limit(known[key]),
            known[key].source == "plan" and not known[key].below,
        )
        for key in dict.fromkeys(key for table in tables for key in table)
    )


def _limit(criterion: CriterionResult) -> str:
    if criterion.below:
        return f"< {criterion.below}"
    parts = [f"≥ {criterion.lower:g}"] if criterion.lower is not None else []
    parts += [f"≤ {criterion.upper:g}"] if criterion.upper is not None else []
    return " ".join(parts)


def _responses(runs: Sequence[ComparedRun]) -> tuple[ResponseRow, ...]:
    rows = []
    for segment in runs[0].result.segments:
        for channel in CHANNELS:
            responses = [aligned(run, segment.id, channel, segment.kind) for run in runs]
            if responses[0] is None:
                continue
            spread = float(np.nanstd(responses[0][1]))
            gaps = tuple(_rms(_between(responses[0], other), spread) for other in responses)
            rows.append(ResponseRow(segment.id, channel, gaps, _ripples(responses, segment, spread)))
    return tuple(rows)


def _ripples(responses: Sequence[Response | None], segment: Segment, spread: float) -> tuple[float, ...]:
    """Sum of the first and each run's rms around a cubic over the last half behind the step."""
    if segment.kind != "step" or spread == 0.0:
        return (float("nan"),) * len(responses)
    first, *others = map(_steady_rms, responses)
    return (0.0, *((first + other) / spread for other in others))


def _steady_rms(response: Response | None) -> float:
    if response is None:
        return float("nan")
    time, values = response
    steady = (time >= 0.5 * time[-1]) & np.isfinite(values)
    if np.count_nonzero(steady) <= _TREND + 1:
        return float("nan")
    trend = np.polynomial.Polynomial.fit(time[steady], values[steady], _TREND)
    return float(np.std(values[steady] - trend(time[steady])))


def difference(
    first: ComparedRun, other: ComparedRun, segment: str, channel: str
) -> tuple[Array, Array] | None:
    """Time from the step in s, and a channel of `other` minus that of `first`, at the first one's samples.

    Over the time that both have; None if one of them has not got the segment or the channel.
    """
    return _between(aligned(first, segment, channel), aligned(other, segment, channel))


def _between(one: Response | None, two: Response | None) -> Response | None:
    if one is None or two is None:
        return None
    time, values = one
    both = (time >= two[0][0]) & (time <= two[0][-1])
    return time[both], np.interp(time[both], *two) - values[both]


def aligned(
    run: ComparedRun, segment: str, channel: str, kind: str | None = None
) -> tuple[Array, Array] | None:
    """Time from the step in s and a channel over a segment; None where a run has not got one of them.

    With a `kind` the segment must be of it.
    """
    found = next((s for s in run.result.segments if s.id == segment and kind in (None, s.kind)), None)
    if found is None or channel not in run.recording:
        return None
    first, last = (run.recording.rows_before(time_s) for time_s in (found.start_s, found.end_s))
    if last - first < _LEAST_SAMPLES:
        return None
    rows = run.recording.rows(first, last, (TIME, channel))
    return rows[TIME] - found.step_s, rows[channel]


def _rms(found: tuple[Array, Array] | None, over: float) -> float:
    if found is None or over == 0.0 or not np.isfinite(found[1]).any():
        return float("nan")
    return float(np.sqrt(np.nanmean(found[1] ** 2)) / over)
