"""Compares a diagnosis with the opened answer."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from hil.core.channels import OUTPUTS
from tests.blind.casefiles import Answer
from tests.blind.diagnosing import Reply
from tests.blind.fairness import is_itself, judged_gaps, label_of, standard_errors_off
from tests.blind.families import FAMILIES
from tests.blind.later_families import LATER_FAMILIES
from tests.blind.specs import Spec

#: The names of the registry; a diagnosis may know more, for what is outside of it.
KNOWN = (*FAMILIES, *(id for id in LATER_FAMILIES if ":" not in id), "parameter_mismatch")
_SURE = 0.9
#: A number of the base that the set hides as an effect: put right it is a wrong number, by another name.
SAME = {
    "parameter_mismatch(torque_delay)": "dead_time",
    "parameter_mismatch(viscous_drag)": "viscous_drag",
}
#: Two ways to give one thing: not compared where the diagnosis gives it the other way.
_ONE_OF = ("contact_damping_nms_rad", "restitution")

Values = Mapping[str, float | str]


@dataclass
class Score:
    """One case, judged. `right` is what its group asks for; see the functions of this module."""

    group: str
    subject: str
    size: str
    turn: int
    kind: str
    hidden: list[str]
    share: float
    verdict: str
    named: list[str]
    right: bool
    failure: str
    processor_s: float
    names_right: list[tuple[float, bool]] = field(default_factory=list)
    honest: bool = True
    parameter_errors: dict[str, float] = field(default_factory=dict)
    gap_over_noise: dict[str, float] = field(default_factory=dict)
    gap_before_over_noise: dict[str, float] = field(default_factory=dict)
    unshrunk: list[str] = field(default_factory=list)
    unexplained: list[str] = field(default_factory=list)
    standard_errors_off: dict[str, float] = field(default_factory=dict)
    started: list[str] = field(default_factory=list)

    @property
    def key(self) -> str:
        return f"{self.group}/{self.subject}/{self.size}/{self.turn}"

    @property
    def worst_gap(self) -> float:
        return max(self.gap_over_noise.values(), default=math.nan)

    @property
    def mean_gap(self) -> float:
        """Root mean square over the channels."""
        values = list(self.gap_over_noise.values())
        return math.sqrt(sum(v * v for v in values) / len(values)) if values else math.nan

    def as_json(self) -> dict[str, Any]:
        return asdict(self)


def score(spec: Spec, kind: str, answer: Answer, reply: Reply) -> Score:
    """Judge a reply."""
    diagnosis = reply.diagnosis
    entries: list[dict[str, Any]] = diagnosis.get("effects", [])
    verdict = "failed" if reply.failure else str(diagnosis.get("verdict"))
    hidden = [SAME.get(label, label) for label in (label_of(id, values) for id, values in answer.effects)]
    named = [name_of(entry, hidden) for entry in entries]
    # a name that the registry does not have is neither right nor wrong
    judged = [
        (float(e.get("confidence", 1.0)), n in hidden)
        for e, n in zip(entries, named, strict=True)
        if e["id"] in KNOWN
    ]
    result = Score(
        spec.group, spec.subject, spec.size, spec.turn, kind, hidden, answer.share, verdict, named,
        _right(spec, hidden, verdict, named, diagnosis), reply.failure, reply.processor_s, judged,
    )  # fmt: skip
    result.started = sorted((diagnosis.get("start") or {}).get("parameters", {}))
    result.unshrunk, result.unexplained = judged_gaps(answer, diagnosis)
    result.standard_errors_off = standard_errors_off(answer, entries, named)
    result.honest = not any(confidence >= _SURE and not true for confidence, true in judged)
    if result.right and spec.group != "outside":
        result.parameter_errors = _parameter_errors(answer, entries, named)
    gaps = diagnosis.get("holdout_gap") or diagnosis.get("gap") or {}
    for channel in OUTPUTS:
        noise = answer.holdout_noise[channel]
        if channel in gaps and noise > 0.0:
            result.gap_over_noise[channel] = float(gaps[channel]["after"]) / noise
            result.gap_before_over_noise[channel] = float(gaps[channel]["before"]) / noise
    return result


def names_of(entry: Mapping[str, Any]) -> list[str]:
    """An effect's name, then those that the data cannot tell from it."""
    alike = str(entry["class"]).split(" or ")[1:] if "class" in entry else []
    label = label_of(str(entry["id"]), entry.get("parameters", {}))
    return [SAME.get(name, name) for name in (label, *alike)]


def name_of(entry: Mapping[str, Any], hidden: Sequence[str]) -> str:
    """That of its names which is hidden, or else its own: a class stands for each of its names."""
    names = names_of(entry)
    return next((name for name in names if name in hidden), names[0])


def _right(
    spec: Spec, hidden: Sequence[str], verdict: str, named: Sequence[str], diagnosis: Mapping[str, Any]
) -> bool:
    """Single, one recording, mismatch: that name alone. Pair: both, no third. None: nothing named.

    Outside: unknown, or names that the registry does not have. Too small: nothing named. Drift: nothing
    named, be it that the drift is taken for noise or that something unknown is seen. Few channels: that
    name alone, or an honest pair of rivals.
    """
    if spec.group == "drift":
        return verdict in ("none", "unknown") and not named
    if spec.group in ("none", "too_small") or spec.subject.startswith("none"):
        return verdict == "none" and not named
    if spec.group == "outside":
        foreign = bool(named) and not any(name.split("(")[0] in KNOWN for name in named)
        return verdict == "unknown" or (verdict == "named" and foreign)
    if verdict == "named" and sorted(named) == sorted(hidden):
        return True
    return spec.group == "few_channels" and honest_rivals(hidden, diagnosis)


def honest_rivals(hidden: Sequence[str], diagnosis: Mapping[str, Any]) -> bool:
    """Whether the likeliest two names hold the truth, none is sure, and a test tells them apart."""
    rivals = [*diagnosis.get("effects", []), *diagnosis.get("alternatives", [])]
    rivals.sort(key=lambda one: -float(one.get("confidence", 0.0)))
    pair = rivals[:2]
    if len(pair) < 2 or len(diagnosis.get("effects", [])) > 1:
        return False
    names = [label_of(one["id"], one.get("parameters", {})) for one in pair]
    tests = any(one.get("separating_test") for one in pair)
    return tests and hidden[0] in names and float(pair[0].get("confidence", 0.0)) < _SURE


def _parameter_errors(
    answer: Answer, entries: Sequence[Mapping[str, Any]], named: Sequence[str]
) -> dict[str, float]:
    errors = {}
    for id, values in answer.effects:
        label = label_of(id, values)
        if label not in named:
            continue  # right by saying nothing, or as one of two rivals
        entry = entries[named.index(label)]
        if not is_itself(entry, label):
            continue
        found = entry["parameters"]
        for name, error in errors_of(id, values, found).items():
            errors[f"{label}.{name}"] = error
    return errors


def errors_of(id: str, truth: Values, found: Values) -> dict[str, float]:
    """Relative errors of an effect's numbers.

    A phase counts in radians, a gain by its distance from 1. Stiffness and slip of a hysteresis are not
    unique (a Bouc-Wen loop is not a Jenkins loop): their product, the torque at which it slips, counts.
    """
    if id == "shaft_hysteresis":
        right, got = (_number(v, "stiffness_nm_rad") * _number(v, "slip_rad") for v in (truth, found))
        return {"slip_torque_nm": abs(got / right - 1.0)}
    errors = {}
    for name, value in truth.items():
        if isinstance(value, str) or (name in _ONE_OF and name not in found):
            continue
        got = _number(found, name)
        if name == "phase_rad":
            errors[name] = abs((got - value + math.pi) % (2.0 * math.pi) - math.pi)
        elif name == "gain":
            errors[name] = abs((got - value) / (value - 1.0))
        else:
            errors[name] = abs(got / value - 1.0)
    return errors


def _number(values: Values, name: str) -> float:
    """A parameter that is not given is an optional one, and zero."""
    return float(values.get(name, 0.0))
