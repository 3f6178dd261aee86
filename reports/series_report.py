"""A series of runs on one page: what each criterion came to over the repeats, and each run's report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from reports import labels
from reports.parts import Page, Part, Table, page_html

SERIES_HTML = "series.html"
_HEAD = (
    "variables", "criterion", "limit", "verdict", "runs",
    "mean", "standard deviation", "lowest", "highest", "unit",
)  # fmt: skip


def series_html(plan: str, bench: str, summary: Mapping[str, Any]) -> str:
    """The page of a series; `summary` is its series.json, whose folders lie beside the page."""
    runs, spread = summary["runs"], summary["spread"]
    verdicts = [run["verdict"] for run in runs]
    passed = sum(verdict in ("pass", "done") for verdict in verdicts)
    headline = f"{passed} of {len(runs)} runs passed"
    return page_html(
        Page(
            kind="Series of runs",
            title=f"{plan} on {bench}",
            headline=headline,
            tone=_tone(verdicts),
            lead=f"{len(spread)} combinations of variables." if len(spread) > 1 else "",
            notes=(),
            parts=(_criteria(spread), _runs(runs)),
        )
    )


def limit_in_words(criterion: Mapping[str, Any]) -> str:
    """The limit of a criterion of series.json: '≤ 250', 'below gain_0kmh' where it moves, '-' without one."""
    lower, upper = criterion["lower"], criterion["upper"]
    found = [f"≥ {lower:.4g}"] if lower is not None else []
    if criterion["below"]:
        found.append(f"below {criterion['below']}")
    elif upper is not None:
        found.append(f"≤ {upper:.4g}")
    return " ".join(found) or "-"


def values_in_words(variables: Mapping[str, float]) -> str:
    """Variables with their values, on a line."""
    return ", ".join(f"{name} = {value:g}" for name, value in variables.items())


def _tone(verdicts: Sequence[str]) -> Literal["pass", "fail", "error", "quiet"]:
    if "error" in verdicts:
        return "error"
    if "fail" in verdicts:
        return "fail"
    return "pass" if "pass" in verdicts else "quiet"


def _criteria(spread: Sequence[Mapping[str, Any]]) -> Part:
    rows = []
    for group in spread:
        for name, one in group["criteria"].items():
            figures = (one[key] for key in ("mean", "standard_deviation", "lowest", "highest"))
            numbers = ("-" if figure is None else f"{figure:.4g}" for figure in figures)
            values = values_in_words(group["variables"])
            facts = (name, limit_in_words(one), one["verdict"].replace("_", " "), str(one["count"]))
            rows.append((values, *facts, *numbers, labels.unit(one["unit"])))
    table = Table(_HEAD, tuple(rows), numbers_from=4, words_from=9)
    return Part("criteria", "Criteria over the runs", "The verdict is the worst of the runs.", (table,))


def _runs(runs: Sequence[Mapping[str, Any]]) -> Part:
    rows = tuple((run["folder"], values_in_words(run["variables"]), run["verdict"]) for run in runs)
    links = tuple(run["report"] for run in runs)
    table = Table(("run", "variables", "verdict"), rows, numbers_from=99, links=links)
    return Part("runs", "Runs", "", (table,))
