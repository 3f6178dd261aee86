"""What a campaign comes to: shares that pass, distributions, worst cases, what each criterion hangs on."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from test_plans import Criterion

Array = npt.NDArray[np.float64]

CONFIDENCE = 0.95
_WORST = 10
_FEWEST = 5  # simulations from which a rank correlation is reported


@dataclass(frozen=True)
class Share:
    """How many of how many; the interval holds the true share with `CONFIDENCE` (Clopper and Pearson)."""

    passed: int
    of: int

    @property
    def value(self) -> float:
        """NaN of none."""
        return self.passed / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Exact, for independent draws; of none: everything."""
        from scipy.stats import binomtest

        if not self.of:
            return 0.0, 1.0
        found = binomtest(self.passed, self.of).proportion_ci(CONFIDENCE, method="exact")
        return float(found.low), float(found.high)


@dataclass(frozen=True)
class OfCriterion:
    """One criterion over the simulations of one controller.

    Attributes:
        values: those that there are, in the metric's unit; limits: of `below` the other segment's differ.
        share: of simulations that were executed.
        correlations: of the value with each input by column, Spearman's ρ; NaN where it has none.
    """

    id: str
    title: str
    unit: str
    upper: float | None
    lower: float | None
    below: str
    values: Array
    share: Share
    correlations: dict[str, float]

    @property
    def limited(self) -> bool:
        """Whether it has a limit."""
        return self.upper is not None or self.lower is not None or bool(self.below)

    def quantile(self, share: float) -> float:
        """NaN without values."""
        return float(np.quantile(self.values, share)) if self.values.size else math.nan


@dataclass(frozen=True)
class Worst:
    """A simulation with little margin: its number, what it had for inputs, and which criterion binds."""

    simulation: int
    draw: int
    margin: float
    binding: str
    verdict: str
    inputs: dict[str, float]


@dataclass(frozen=True)
class OfController:
    """What the simulations of one controller came to; '' is the plan's own."""

    name: str
    share: Share
    errors: int
    criteria: tuple[OfCriterion, ...]
    worst: tuple[Worst, ...]


@dataclass(frozen=True)
class Findings:
    """What a campaign came to.

    Attributes:
        inputs: units by column of what differs between simulations.
        errors: what went wrong, and how often, most often first.
    """

    simulations: int
    inputs: dict[str, str]
    controllers: tuple[OfController, ...]
    errors: dict[str, int]
    processor_s: float

    @property
    def least_share(self) -> float:
        """Of the controller that passes least often."""
        return min((one.share.value for one in self.controllers), default=math.nan)


def findings_of(table: pd.DataFrame, criteria: Sequence[Criterion], inputs: dict[str, str]) -> Findings:
    """Evaluate the table of a campaign (docs/reference/campaigns.md)."""
    names = list(dict.fromkeys(table["controller"]))
    varied = {name: unit for name, unit in inputs.items() if table[name].nunique() > 1}
    reasons = table.loc[table["error"].notna(), "error"].value_counts()
    return Findings(
        len(table),
        varied,
        tuple(_of_controller(name, table[table["controller"] == name], criteria, varied) for name in names),
        {str(words): int(count) for words, count in reasons.items()},
        float(table["processor_s"].sum()),
    )


def _of_controller(
    name: str, table: pd.DataFrame, criteria: Sequence[Criterion], inputs: dict[str, str]
) -> OfController:
    passed = int((table["verdict"] == "pass").sum())
    return OfController(
        name,
        Share(passed, len(table)),
        int((table["verdict"] == "error").sum()),
        tuple(_of_criterion(one, table, inputs) for one in criteria),
        _worst(table, criteria, inputs),
    )


def _of_criterion(criterion: Criterion, table: pd.DataFrame, inputs: dict[str, str]) -> OfCriterion:
    values, verdicts = table[f"value.{criterion.id}"], table[f"verdict.{criterion.id}"]
    carried_out = verdicts.notna()
    passed = verdicts.isin(["pass", "informational"])
    return OfCriterion(
        criterion.id,
        criterion.title,
        criterion.metric.unit,
        criterion.upper,
        criterion.lower,
        criterion.below or "",
        values.dropna().to_numpy(float),
        Share(int(passed.sum()), int(carried_out.sum())),
        {name: rank_correlation(table[name].to_numpy(float), values.to_numpy(float)) for name in inputs},
    )


def rank_correlation(first: Array, second: Array) -> float:
    """Spearman's ρ of two series where both have values; NaN of fewer than 5, or of a constant."""
    there = np.isfinite(first) & np.isfinite(second)
    if np.sum(there) < _FEWEST:
        return math.nan
    from scipy.stats import rankdata

    ranks = [rankdata(one[there]) for one in (first, second)]
    spread = [float(np.std(one)) for one in ranks]
    if min(spread) == 0:
        return math.nan
    return float(
        np.mean((ranks[0] - ranks[0].mean()) * (ranks[1] - ranks[1].mean())) / (spread[0] * spread[1])
    )


def _worst(table: pd.DataFrame, criteria: Sequence[Criterion], inputs: dict[str, str]) -> tuple[Worst, ...]:
    """Those with the least margin, least first."""
    margins = {one.id: f"margin.{one.id}" for one in criteria}
    found = []
    for _, row in table[table["margin"].notna()].nsmallest(_WORST, "margin", keep="first").iterrows():
        known = {id_: float(row[column]) for id_, column in margins.items() if pd.notna(row[column])}
        found.append(
            Worst(
                int(row["simulation"]),
                int(row["draw"]),
                float(row["margin"]),
                min(known, key=lambda id_: known[id_]),
                str(row["verdict"]),
                {name: float(row[name]) for name in inputs if pd.notna(row[name])},
            )
        )
    return tuple(found)
