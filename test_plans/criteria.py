"""Criteria: a metric of a segment, and the limits it must keep."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, Field

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean
from test_plans.building import Strict, build, key_names, mapping_at
from test_plans.conductor import PlannedSegment
from test_plans.metrics import METRICS, Limits, Metric
from test_plans.yaml_document import Document, KeyPath

EXAMPLE = "{segment: gain_0kmh, metric: peak_shaft_torque, upper: 723, unit: N m}"
Segments = dict[str, PlannedSegment]


class CriterionKeys(Strict):
    """The keys of a criterion that do not depend on its metric."""

    segment: str = Field(description="id of a segment of this plan")
    metric: str = Field(description="name of a metric")
    upper: float | None = Field(default=None, description="largest allowed value, in the metric's unit")
    lower: float | None = Field(default=None, description="smallest allowed value, in the metric's unit")
    unit: str | None = Field(default=None, description="unit of the limits; must be the metric's")
    below: str | None = Field(
        default=None, description="id of a segment in which the same metric must be larger"
    )
    title: str = Field(default="", max_length=200, description="title in the report")
    id: str | None = Field(
        default=None, pattern=r"^[A-Za-z0-9_.-]{1,200}$", description="default: segment and metric"
    )


class Criterion(Strict):
    """One criterion of a plan. Without limits it is informational: neither passed nor failed."""

    id: str
    segment: str
    metric: Metric
    upper: float | None = None
    lower: float | None = None
    below: str | None = None
    title: str = ""
    source: Literal["plan", "device"] = "plan"

    @property
    def definition(self) -> str:
        """How the value is computed and, with `below`, what it is compared with."""
        compared = (
            f" It must be lower than in segment {self.below}, by more than two standard errors of noise."
            if self.below
            else ""
        )
        return self.metric.definition + compared


def criterion_at(value: object, document: Document, path: KeyPath, segments: Segments | None) -> Criterion:
    """Make the criterion that stands at `path`; without `segments` it is not asked whether its own exist.

    Raises:
        BadInputError: names line and key of what is unknown, missing or contradictory.
    """
    entry = mapping_at(value, document, path, EXAMPLE)
    metric_class = _metric_class(entry, document, path)
    own = {key: entry[key] for key in entry if key in CriterionKeys.model_fields}
    parameters = {key: entry[key] for key in entry if key not in own}
    _refuse_unknown(parameters, metric_class, document, path)
    keys = build(CriterionKeys, own, document, path)
    metric = build(metric_class, parameters, document, path)
    if segments is not None:
        _check_segments(keys, metric, segments, document, path)
    _check_limits(keys, metric, document, path)
    if segments is not None:
        _check_sides(keys, metric, segments[keys.segment], document, path)
    default_id = f"{keys.segment}.{keys.metric}" + (f".below.{keys.below}" if keys.below else "")
    return Criterion(
        id=keys.id or default_id,
        segment=keys.segment,
        metric=metric,
        upper=keys.upper,
        lower=keys.lower,
        below=keys.below,
        title=keys.title,
    )


def _metric_class(entry: dict[str, Any], document: Document, path: KeyPath) -> type[Metric]:
    name = entry.get("metric")
    if not isinstance(name, str):
        raise BadInputError(
            "a criterion needs a 'metric'",
            where=document.place((*path, "metric")),
            fix=f"known: {', '.join(METRICS.names())}",
        )
    found = METRICS.find(name)
    if found is None:
        raise BadInputError(
            f"unknown metric {name!r}", where=document.place((*path, "metric")), fix=METRICS.suggestion(name)
        )
    return found


def _refuse_unknown(
    parameters: dict[str, Any], metric: type[BaseModel], document: Document, path: KeyPath
) -> None:
    known = [*CriterionKeys.model_fields, *key_names(metric)]
    for key in parameters:
        if key not in known:
            raise BadInputError(
                f"unknown key {key!r}", where=document.place((*path, key)), fix=did_you_mean(key, known)
            )


def _check_segments(
    keys: CriterionKeys, metric: Metric, segments: Segments, document: Document, path: KeyPath
) -> None:
    for key, id_ in (("segment", keys.segment), ("below", keys.below)):
        if id_ is None:
            continue
        where = document.place((*path, key))
        if id_ not in segments:
            raise BadInputError(
                f"no step produces a segment {id_!r}", where=where, fix=did_you_mean(id_, segments)
            )
        objection = metric.objection(segments[id_])
        if objection:
            raise BadInputError(f"'{metric.name}' in segment '{id_}': {objection}", where=where)
    if keys.below == keys.segment:
        raise BadInputError(
            "'below' names the criterion's own segment", where=document.place((*path, "below"))
        )


def _check_limits(keys: CriterionKeys, metric: Metric, document: Document, path: KeyPath) -> None:
    if keys.below is not None and keys.upper is not None:
        raise BadInputError(
            "'below' is an upper limit already",
            where=document.place((*path, "upper")),
            fix="write two criteria",
        )
    if keys.upper is not None and keys.lower is not None and keys.lower > keys.upper:
        raise BadInputError(
            f"lower = {keys.lower:g} is above upper = {keys.upper:g}", where=document.place((*path, "lower"))
        )
    toothless = keys.upper is None and keys.below is None and keys.lower is not None and keys.lower <= 0
    if toothless and metric.never_negative:
        raise BadInputError(
            f"no value can violate lower = {keys.lower:g}: '{keys.metric}' is never negative",
            where=document.place((*path, "lower")),
            fix="give an upper limit, or a lower one above 0",
        )
    if metric.never_negative and keys.upper is not None and keys.upper < 0:
        raise BadInputError(
            f"no value can meet upper = {keys.upper:g}: '{keys.metric}' is never negative",
            where=document.place((*path, "upper")),
            fix="give an upper limit of 0 or more",
        )
    if keys.unit is not None and _plain(keys.unit) != _plain(metric.unit):
        raise BadInputError(
            f"the unit of '{keys.metric}' is '{metric.unit}', not {keys.unit!r}",
            where=document.place((*path, "unit")),
            fix="convert the limits, or choose another metric",
        )


def _check_sides(
    keys: CriterionKeys, metric: Metric, segment: PlannedSegment, document: Document, path: KeyPath
) -> None:
    """Refuse a limit on the side to which the step does not go: nothing could break it."""
    objection = metric.objection_to_limits(segment, Limits(keys.upper, keys.lower, keys.below or ""))
    if objection:
        what, _, fix = objection.partition(": ")
        key = "below" if keys.below else "upper" if keys.upper is not None else "lower"
        raise BadInputError(
            f"'{metric.name}' in segment '{keys.segment}': {what}",
            where=document.place((*path, key)),
            fix=fix,
        )


def _plain(unit: str) -> str:
    # "Nm" and "N m", "^2" and "²" are ways to type the same.
    return unit.replace(" ", "").replace("·", "").replace("*", "").replace("^2", "²")
