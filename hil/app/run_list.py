"""Runs that lie below a folder: found by their `result.json`, chosen and sorted."""

from __future__ import annotations

import datetime
import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from hil.app.result_file import RESULT
from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from hil.core.files import read_text
from hil.core.result import CriterionResult, Verdict

RunOrder = Literal["run", "plan", "bench", "verdict", "started", "margin", "value"]
ORDERS: tuple[str, ...] = get_args(RunOrder)
VERDICTS: tuple[str, ...] = get_args(Verdict)


@dataclass(frozen=True, kw_only=True)
class RunsWanted:
    """Which runs, in which order; an empty filter lets all pass.

    Attributes:
        since: started at or after; `until`: before; both with a time zone.
        criterion: only runs that have it; `above` and `below` bound its value, in its unit, both included.
        rising: smallest, first or oldest on top.
        most: number of runs given at most.
    """

    plan: tuple[str, ...] = ()
    bench: tuple[str, ...] = ()
    verdict: tuple[str, ...] = ()
    since: datetime.datetime | None = None
    until: datetime.datetime | None = None
    criterion: str = ""
    above: float | None = None
    below: float | None = None
    sort: str = "started"
    rising: bool = False
    most: int | None = None


@dataclass(frozen=True)
class FoundRun:
    """A run: its folder, what it was, and the criterion with the least margin (None: no limit was set).

    `wanted` is the criterion that was asked for.
    """

    folder: Path
    plan: str
    bench: str
    started: datetime.datetime | None
    verdict: str
    worst: CriterionResult | None
    wanted: CriterionResult | None

    @property
    def margin(self) -> float | None:
        """The least margin, a share of its limit."""
        return None if self.worst is None else self.worst.margin

    def as_json(self) -> dict[str, Any]:
        """For `--json`."""
        return {
            "run": str(self.folder),
            "plan": self.plan,
            "bench": self.bench,
            "started_at": "" if self.started is None else self.started.isoformat(),
            "verdict": self.verdict,
            "worst_margin": self.margin,
            "worst_criterion": "" if self.worst is None else self.worst.id,
            "criterion": None if self.wanted is None else self.wanted.model_dump(mode="json"),
        }


@dataclass(frozen=True)
class FoundRuns:
    """Runs in order, how many passed the filter, of how many, and files that could not be read."""

    runs: tuple[FoundRun, ...]
    total: int
    read: int
    unread: tuple[Path, ...]


def find_runs(folder: Path, wanted: RunsWanted) -> FoundRuns:
    """Runs below a folder.

    Raises:
        BadInputError: there is no such folder, a filter cannot be meant, or no run has the criterion.
    """
    _refuse_wrong(wanted)
    if not folder.is_dir():
        raise BadInputError("is not a folder", where=str(folder), fix="give the folder that runs are in")
    found, unread, read = [], [], 0
    criteria: set[str] = set()
    names: dict[str, set[str]] = {"plan": set(), "bench": set()}
    for path in _results_below(folder):
        try:
            run = _read(path, wanted.criterion, criteria)
        except (ValueError, KeyError, TypeError, AttributeError, BadInputError):
            unread.append(path)
            continue
        if run is None:
            continue
        read += 1
        names["plan"].add(run.plan)
        names["bench"].add(run.bench)
        if _passes(run, wanted):
            found.append(run)
    if wanted.criterion and read and wanted.criterion not in criteria:
        raise BadInputError(
            f"no run has the criterion '{printable(wanted.criterion, 80)}'",
            where="--criterion",
            fix=did_you_mean(wanted.criterion, sorted(criteria)),
        )
    _refuse_unknown(wanted, names)
    known = [run for run in found if _rank(run, wanted.sort) is not None]
    known.sort(key=lambda run: (_rank(run, wanted.sort), str(run.folder)), reverse=not wanted.rising)
    rest = [run for run in found if _rank(run, wanted.sort) is None]
    runs = [*known, *rest]
    return FoundRuns(tuple(runs[: wanted.most]), len(runs), read, tuple(unread))


def _refuse_wrong(wanted: RunsWanted) -> None:
    for name, known, option, what in (
        *((name, VERDICTS, "--verdict", "verdict") for name in wanted.verdict),
        (wanted.sort, ORDERS, "--sort", "order"),
    ):
        if name not in known:
            text = f"there is no {what} '{printable(name, 60)}'"
            raise BadInputError(text, where=option, fix=did_you_mean(name, known))
    if not wanted.criterion and (wanted.above is not None or wanted.below is not None):
        raise BadInputError("a bound needs a criterion", where="--above, --below", fix="add --criterion ID")
    for option, bound in (("--above", wanted.above), ("--below", wanted.below)):
        if bound is not None and not math.isfinite(bound):
            raise BadInputError(f"a bound of {bound} bounds nothing", where=option, fix="give a number")
    if wanted.above is not None and wanted.below is not None and wanted.above > wanted.below:
        text = f"no value is above {wanted.above:g} and below {wanted.below:g}"
        raise BadInputError(text, where="--above, --below", fix="exchange them")
    if wanted.sort == "value" and not wanted.criterion:
        raise BadInputError("a value is that of a criterion", where="--sort value", fix="add --criterion ID")


def _refuse_unknown(wanted: RunsWanted, names: Mapping[str, set[str]]) -> None:
    """Refuse a plan or bench that no run has: a misspelt name would look like an empty list."""
    for what, asked in (("plan", wanted.plan), ("bench", wanted.bench)):
        for name in asked:
            if names[what] and name not in names[what]:
                text = f"no run has the {what} '{printable(name, 60)}'"
                raise BadInputError(text, where=f"--{what}", fix=did_you_mean(name, sorted(names[what])))


def _results_below(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        folders.sort()
        if RESULT in files:
            yield Path(place) / RESULT


def _read(path: Path, criterion: str, known: set[str]) -> FoundRun | None:
    """A run by its result, whose criteria become `known`; None of a file of that name that is none."""
    data = json.loads(read_text(path))
    if not isinstance(data, dict):
        raise TypeError("a result is an object")
    if "verdict" not in data or "plan" not in data:
        return None
    judged = [one for one in data.get("criteria", ()) if one.get("source", "plan") == "plan"]
    criteria = [CriterionResult.model_validate(one) for one in judged]
    known.update(one.id for one in criteria)
    limited = [one for one in criteria if one.margin is not None]
    started = data.get("started_at") or ""
    return FoundRun(
        path.parent,
        str(data["plan"]),
        str(data.get("bench", "")),
        _in_utc(datetime.datetime.fromisoformat(started)) if started else None,
        str(data["verdict"]),
        min(limited, key=lambda one: one.margin or 0.0, default=None),
        next((one for one in criteria if criterion and one.id == criterion), None),
    )


def _in_utc(moment: datetime.datetime) -> datetime.datetime:
    return moment.replace(tzinfo=datetime.UTC) if moment.tzinfo is None else moment


def _passes(run: FoundRun, wanted: RunsWanted) -> bool:
    chosen = (
        (not wanted.plan or run.plan in wanted.plan)
        and (not wanted.bench or run.bench in wanted.bench)
        and (not wanted.verdict or run.verdict in wanted.verdict)
    )
    if not chosen:
        return False
    if wanted.since and (run.started is None or run.started < wanted.since):
        return False
    if wanted.until and (run.started is None or run.started >= wanted.until):
        return False
    return not wanted.criterion or _within(run.wanted, wanted)


def _within(criterion: CriterionResult | None, wanted: RunsWanted) -> bool:
    if criterion is None:
        return False
    if wanted.above is None and wanted.below is None:
        return True
    value = criterion.value
    return value is not None and not (
        (wanted.above is not None and value < wanted.above)
        or (wanted.below is not None and value > wanted.below)
    )


def _rank(run: FoundRun, order: str) -> Any:
    if order == "value":
        return None if run.wanted is None else run.wanted.value
    if order == "run":
        return str(run.folder)
    return getattr(run, order)
