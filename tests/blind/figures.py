"""The figures that are asked of a diagnosis, each with its line and its target."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from tests.blind.fairness import holds
from tests.blind.scoring import Score

Rows = list[list[object]]


def figure_rows(scores: Sequence[Score]) -> Rows:
    """[figure, cases, value, line, target] of every figure that these cases tell something about."""
    rows: Rows = []
    for title, chosen, line, target in _SHARES:
        members = [s for s in scores if chosen(s)]
        if members:
            share = f"{100.0 * float(np.mean([s.right for s in members])):.0f} %"
            rows.append([title, len(members), share, line, target])
    rows += _other_laws([s for s in scores if s.group == "other_laws"])
    rows += _counts(scores)
    held = [holds(off) for s in scores for off in s.standard_errors_off.values()]
    if held:
        share = f"{100.0 * float(np.mean(held)):.0f} %"
        rows.append(["95 % intervals that hold the true number", len(held), share, "85 %", "93 to 97 %"])
    times = [s.processor_s for s in scores if not s.failure]
    if times:
        rows.append(
            ["processor time per case, median / 95th, s", len(times), _two(times), "15 / 60", "8 / 25"]
        )
    return rows


def _hides_something(one: Score) -> bool:
    return bool(one.hidden)


_SHARES: tuple[tuple[str, Callable[[Score], bool], str, str], ...] = (
    ("far base, right name alone", lambda s: s.group == "far" and _hides_something(s), "85 %", "95 %"),
    ("far base, nothing hidden: none", lambda s: s.group == "far" and not s.hidden, "100 %", "100 %"),
    (
        "one channel: right name, or honest rivals",
        lambda s: s.group == "few_channels" and s.subject.endswith("@one"),
        "85 %",
        "95 %",
    ),
    (
        "two channels: right name, or honest rivals",
        lambda s: s.group == "few_channels" and s.subject.endswith("@two"),
        "85 %",
        "95 %",
    ),
    ("closed loop, right", lambda s: s.group == "closed_loop", "95 %", "99 %"),
    ("other laws, right name alone", lambda s: s.group == "other_laws", "-", "-"),
    ("too small: nothing named", lambda s: s.group == "too_small", "100 %", "100 %"),
    ("drift: nothing named", lambda s: s.group == "drift", "100 %", "100 %"),
    ("load side, right", lambda s: s.group == "load_side", "-", "-"),
)


def _other_laws(members: Sequence[Score]) -> Rows:
    ratios = [s.mean_gap for s in members if s.gap_over_noise]
    if not ratios:
        return []
    return [
        [
            "other laws, held-out gap / noise, median / 95th",
            len(ratios),
            _two(ratios),
            "1.2 / 3",
            "1.05 / 1.5",
        ]
    ]


def _counts(scores: Sequence[Score]) -> Rows:
    rows: Rows = []
    for title, verdict, wrong in (
        ("`named` while a channel's gap shrank by less than half", "named", lambda s: bool(s.unshrunk)),
        ("`none` while an error is over twice the noise", "none", lambda s: bool(s.unexplained)),
    ):
        members = [s for s in scores if s.verdict == verdict]
        if members:
            rows.append([title, len(members), sum(map(wrong, members)), 0, 0])
    return rows


def _two(values: Sequence[float]) -> str:
    median, high = np.quantile([v for v in values if np.isfinite(v)], (0.5, 0.95))
    return f"{median:.3g} / {high:.3g}"
