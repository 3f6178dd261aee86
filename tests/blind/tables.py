"""The results as Markdown."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from tests.blind.fairness import holds
from tests.blind.figures import figure_rows
from tests.blind.later_groups import LATER_GROUPS
from tests.blind.scoring import Score
from tests.blind.specs import GROUPS, SIZES

#: group: (line, target) in percent
LINES = {
    "single": (95, 99),
    "pair": (85, 95),
    "none": (100, 100),
    "outside": (80, 95),
    "far": (85, 95),
    "few_channels": (85, 95),
    "closed_loop": (95, 99),
    "too_small": (100, 100),
    "drift": (100, 100),
}
_BINS = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.0001)


def as_markdown(scores: Sequence[Score], how: str) -> str:
    """The whole page; `how` says with what the figures were made."""
    parts = ["# Results of the blind set", how + " [What the groups are](blind-set.md).", *_summary(scores)]
    singles = [s for s in scores if s.group == "single"]
    parts += ["## Single effects by size", _by(singles, lambda s: s.size, "size", [*SIZES])]
    parts += ["## Single effects by name", _by(singles, lambda s: s.subject, "effect")]
    parts += ["## By model kind", _by(scores, lambda s: s.kind, "kind")]
    parts += [
        "## Outside the registry",
        _by([s for s in scores if s.group == "outside"], lambda s: s.subject, "effect"),
    ]
    later = [s for s in scores if s.group in LATER_GROUPS]
    parts += ["## Later groups by subject", _by(later, lambda s: f"{s.group}/{s.subject}", "subject")]
    parts += ["## Confusions", "What was named where one effect, or none, was hidden.", _confusions(scores)]
    parts += ["## Calibration of confidence", _calibration(scores)]
    parts += ["## Parameter errors, right answers", _parameters(scores)]
    parts += [
        "## Intervals by number",
        "Of the registry's own laws: 95 % intervals that hold the true number, and how far numbers are off.",
        _intervals(scores),
        "## Intervals that miss",
        _missed(scores),
    ]
    parts += ["## Not right", _failures(scores)]
    return "\n\n".join(parts) + "\n"


def _summary(scores: Sequence[Score]) -> list[str]:
    rows = []
    for group in GROUPS:
        members = [s for s in scores if s.group == group]
        if not members:
            continue
        line, target = LINES.get(group, ("-", "-"))
        honest = np.mean([s.honest for s in members])
        rows.append([group, len(members), _percent(members), line, target, f"{100 * honest:.0f}"])
    parts = [
        "## Accuracy",
        "Right: the name alone (single, one recording, mismatch), both names and no third (pair), nothing "
        "named (none), `unknown` (outside). A sensor's name counts with its channel, a mismatch with its "
        "parameter. Honest: no wrong name with a confidence of 0.9 or more.",
        _table(["group", "cases", "right %", "line %", "target %", "honest %"], rows),
        "Far: the same as single, or nothing where nothing is hidden, from a base whose parameters are all "
        "20 to 80 % off but for the gear ratio; what is found of the base stands under `start`. Few "
        "channels: the name alone, or two honest rivals with a test that tells them apart. Too small and "
        "drift: nothing named.",
        "## Figures",
        "Shrank: of what a gap has over the true noise, by squares; a channel counts if its gap was 1.1 "
        "times the noise.",
        _table(["figure", "of", "value", "line", "target"], figure_rows(scores)),
        "## Gap and parameters",
        "Gap after over the true noise on held-out recordings, in single-effect cases: rms over the "
        "channels, and the worst channel.",
    ]
    singles = [s for s in scores if s.group == "single" and s.gap_over_noise]
    errors = [
        e for s in scores if s.group == "single" for n, e in s.parameter_errors.items() if "phase" not in n
    ]
    rows = [
        ["gap after / noise", *_quantiles([s.mean_gap for s in singles]), "1.10 / 1.5", "1.02 / 1.15"],
        ["gap after / noise, worst channel", *_quantiles([s.worst_gap for s in singles]), "", ""],
        ["parameter error", *_quantiles(errors), "0.05", "0.01"],
    ]
    return [*parts, _table(["figure", "median", "95th percentile", "line", "target"], rows)]


def _by(scores: Iterable[Score], key: Callable[[Score], str], title: str, order: Sequence[str] = ()) -> str:
    groups: dict[str, list[Score]] = {name: [] for name in order}
    for one in scores:
        groups.setdefault(key(one), []).append(one)
    rows = [
        [
            name,
            len(members),
            _percent(members),
            *_quantiles([s.mean_gap for s in members if s.gap_over_noise]),
        ]
        for name, members in (groups.items() if order else sorted(groups.items()))
        if members
    ]
    return _table([title, "cases", "right %", "gap / noise, median", "95th percentile"], rows)


def _confusions(scores: Sequence[Score]) -> str:
    counts: Counter[tuple[str, str]] = Counter()
    for one in scores:
        if one.group != "pair":
            counts[one.subject, _said(one)] += 1
    rows = [[truth, said, number] for (truth, said), number in sorted(counts.items())]
    return _table(["hidden", "answer", "cases"], rows)


def _said(one: Score) -> str:
    names = sorted({name.split("(")[0] if name.split("(")[0] != one.subject else name for name in one.named})
    if one.right and one.named and one.group not in ("pair", "outside"):
        return "the same"
    return f"{one.verdict}: {' + '.join(names)}" if names else one.verdict


def _calibration(scores: Sequence[Score]) -> str:
    names = [pair for s in scores for pair in s.names_right]
    rows = []
    for low, high in itertools.pairwise(_BINS):
        inside = [(confidence, true) for confidence, true in names if low <= confidence < high]
        if inside:
            stated, true = np.mean(np.array(inside, dtype=float), axis=0)
            rows.append([f"{low:g} to {min(high, 1.0):g}", len(inside), f"{stated:.2f}", f"{true:.2f}"])
    return _table(["stated confidence", "names", "mean stated", "share right"], rows)


def _parameters(scores: Sequence[Score]) -> str:
    errors: dict[str, list[float]] = {}
    for one in scores:
        for name, error in one.parameter_errors.items():
            errors.setdefault(_number(name), []).append(error)
    rows = [[name, len(values), *_quantiles(values)] for name, values in sorted(errors.items())]
    return _table(["parameter", "cases", "median error", "95th percentile"], rows)


def _number(name: str) -> str:
    """`effect.number`, whatever channel or parameter the effect is about."""
    return f"{name.split('(')[0].split('.')[0]}.{name.split('.')[-1]}"


def _intervals(scores: Sequence[Score]) -> str:
    found: dict[str, list[float]] = {}
    for one in scores:
        for name, off in one.standard_errors_off.items():
            found.setdefault(_number(name), []).append(off)
    rows = [
        [name, len(offs), f"{100 * float(np.mean([holds(off) for off in offs])):.0f}", f"{_rms(offs):.2f}"]
        for name, offs in sorted(found.items())
    ]
    return _table(["number", "intervals", "hold %", "rms of standard errors off"], rows)


def _rms(values: Sequence[float]) -> float:
    return math.sqrt(float(np.mean(np.square(values))))


def _missed(scores: Sequence[Score]) -> str:
    rows = [
        [one.key, one.kind, name, f"{off:+.1f}"]
        for one in scores
        for name, off in one.standard_errors_off.items()
        if not holds(off)
    ]
    return _table(["case", "kind", "number", "standard errors off"], rows)


def _failures(scores: Sequence[Score]) -> str:
    rows = [
        [
            one.key,
            one.kind,
            " + ".join(one.hidden),
            one.failure or _named(one),
            f"{one.share:.2f}",
            f"{one.worst_gap:.2f}",
        ]
        for one in scores
        if not one.right
    ]
    return _table(["case", "kind", "hidden", "answer", "share", "worst gap / noise"], rows)


def _named(one: Score) -> str:
    pairs = itertools.zip_longest(one.named, one.names_right, fillvalue=(math.nan, False))
    return f"{one.verdict}: " + ", ".join(f"{name} {sure[0]:.2f}" for name, sure in pairs)


def _percent(members: Sequence[Score]) -> str:
    return f"{100 * float(np.mean([s.right for s in members])):.0f}"


def _quantiles(values: Sequence[float]) -> list[str]:
    finite = [v for v in values if math.isfinite(v)]
    if not finite:
        return ["-", "-"]
    return [f"{np.median(finite):.3g}", f"{np.quantile(finite, 0.95):.3g}"]


def _table(head: Sequence[object], rows: Sequence[Sequence[object]]) -> str:
    if not rows:
        return "No cases."
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)
