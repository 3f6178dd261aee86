"""Two runs side by side: what `hil compare` finds, and their traces as envelopes."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

from hil.analysis.comparison import ComparedRun, aligned, compare, differences, plan_summary
from hil.core.channels import TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.recording import read_recording
from hil.service.worker_pool.drawn_numbers import envelope, number, numbers
from test_plans import rejudged

_KEPT = 4  # recordings that stay read
_MOST_DIFFERENCES = 200


def comparison(first: list[str], other: list[str]) -> dict[str, Any]:
    """Fields of `ComparisonData`, runs given as (name, recording).

    Raises:
        BadInputError: a recording cannot be read, or they have no channel in common.
    """
    one, two = _run(*first), _run(*other)
    try:
        found = compare([one, two])
    except BadInputError as error:
        raise _by_name(error, one, two) from None
    all_differences = differences(one, two)
    of_plan = plan_summary(one, two)
    left = len(all_differences) - _MOST_DIFFERENCES
    more = [f"{left} more differences of the inputs are not listed."] if left > 0 else []
    return {
        "plan": one.result.plan,
        "verdicts": [one.result.verdict, two.result.verdict],
        "distance": found.distances[1],
        "differences": [vars(each) for each in all_differences[:_MOST_DIFFERENCES]],
        "plan_summary": [vars(each) for each in of_plan.shown],
        "plan_more": of_plan.more,
        "notes": [*found.notes, *more],
        "criteria": [
            {
                "id": row.id,
                "title": row.title,
                "unit": row.unit,
                "limit": row.limit,
                "values": [number(value) for value in row.values],
                "verdicts": row.verdicts,
                "relative": row.relative[1],
                "better": _better(row.id, one, two),
                "source": _source(row.id, one, two),
            }
            for row in found.criteria
        ],
        "responses": [
            {"segment": row.segment, "channel": row.channel, "gap": number(row.gaps[1])}
            for row in found.responses
        ],
        "segments": [
            {
                "id": segment.id,
                "kind": segment.kind,
                "start_s": segment.start_s - segment.step_s,
                "end_s": segment.end_s - segment.step_s,
                "channels": _common(one, two),
            }
            for segment in one.result.segments
            if any((segment.id, segment.kind) == (each.id, each.kind) for each in two.result.segments)
        ],
    }


def traces(
    first: list[str],
    other: list[str],
    segment: str,
    channel: str,
    start_s: float | None,
    end_s: float | None,
    most: int,
) -> dict[str, Any]:
    """Fields of `TracesData`: lowest and highest value in equal buckets of the time from each run's step.

    Raises:
        BadInputError: a run has not got the segment or the channel.
    """
    runs = [_run(*first), _run(*other)]
    found = []
    for run in runs:
        stretch = aligned(run, segment, channel)
        if stretch is None:
            raise BadInputError(
                f"has no '{channel}' in a segment '{segment}'", where=run.name, fix="see its comparison"
            )
        found.append(stretch)
    from_s = max(start_s if start_s is not None else -np.inf, min(time[0] for time, _ in found))
    to_s = min(end_s if end_s is not None else np.inf, max(time[-1] for time, _ in found))
    if not from_s < to_s:
        raise BadInputError("no data were measured in this period", where=segment)
    finest_s = min(float(np.median(np.diff(time))) for time, _ in found)
    width_s = max((to_s - from_s) / most, finest_s)
    count = int(np.ceil((to_s - from_s) / width_s * (1 - 1e-9)))
    envelopes = [envelope(*stretch, from_s, width_s, count) for stretch in found]
    return {
        "segment": segment,
        "channel": channel,
        "unit": runs[0].recording.metadata.get("units", {}).get(channel) or unit_of(channel),
        "start_s": from_s,
        "width_s": width_s,
        "runs": [{"lowest": numbers(low), "highest": numbers(high)} for low, high in envelopes],
    }


@functools.lru_cache(_KEPT)
def _run(name: str, path: str) -> ComparedRun:
    recording = read_recording(Path(path), allow_missing=True)
    result = rejudged(recording)
    if result is None:
        raise BadInputError("is not a run of a plan", where=name)
    return ComparedRun(name, recording, result)


def _by_name(error: BadInputError, *runs: ComparedRun) -> BadInputError:
    """The same in which runs are called by their names and not by where their files lie."""
    what, where = error.what, error.where
    for run in runs:
        path = str(run.recording.source)
        what, where = what.replace(path, run.name), where.replace(path, run.name)
    return BadInputError(what, where=where, fix=error.fix)


def _better(criterion: str, *runs: ComparedRun) -> str:
    """Which way is better by the limits of a criterion: `lower`, `higher`, or '' where they do not say."""
    ones = [one for run in runs for one in run.result.criteria if one.id == criterion]
    bounded = {(one.upper is not None or one.below != "", one.lower is not None) for one in ones}
    return "lower" if bounded == {(True, False)} else "higher" if bounded == {(False, True)} else ""


def _source(criterion: str, *runs: ComparedRun) -> str:
    every = [one for run in runs for one in run.result.criteria]
    return next((one.source for one in every if one.id == criterion), "plan")


def _common(one: ComparedRun, two: ComparedRun) -> list[str]:
    return [name for name in one.recording.channels if name != TIME and name in two.recording]
