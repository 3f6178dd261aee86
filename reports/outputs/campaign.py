"""What `hil campaign` writes beside its table: `campaign.json`, and the text for people."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hil.analysis.campaigns import Findings, OfController, OfCriterion, Share, Worst
from hil.core.errors.wording import share as percent

QUANTILES = (0.01, 0.05, 0.5, 0.95, 0.99)
OWN = "the plan's own"


def name_of(controller: OfController) -> str:
    """For people."""
    return controller.name or OWN


def passed(found: Findings, wanted: float | None) -> bool | None:
    """Whether each controller passes as often as is wanted; None if nothing is."""
    return None if wanted is None else found.least_share >= wanted


def summary_of(
    found: Findings, asked: Mapping[str, Any], *, random: bool, wanted: float | None, files: list[str]
) -> dict[str, Any]:
    """The content of `campaign.json`; `asked` is what the campaign is, `random` whether cars are drawn."""
    return {
        **asked,
        "simulations": found.simulations,
        "pass_share_wanted": wanted,
        "passed": passed(found, wanted),
        "inputs": dict(found.inputs),
        "controllers": [_of_controller(one, random) for one in found.controllers],
        "errors": dict(found.errors),
        "processor_s": found.processor_s,
        "files": files,
    }


def _of_controller(one: OfController, random: bool) -> dict[str, Any]:
    return {
        "controller": one.name,
        "share": _share(one.share, random),
        "errors": one.errors,
        "criteria": [_of_criterion(criterion, random) for criterion in one.criteria],
        "worst": [_worst(worst) for worst in one.worst],
    }


def _share(share: Share, random: bool) -> dict[str, Any]:
    return {
        "passed": share.passed,
        "of": share.of,
        "share": share.value,
        "interval": list(share.interval) if random else None,
    }


def _of_criterion(one: OfCriterion, random: bool) -> dict[str, Any]:
    return {
        "id": one.id,
        "unit": one.unit,
        "upper": one.upper,
        "lower": one.lower,
        "below": one.below,
        "share": _share(one.share, random) if one.limited else None,
        "values": one.values.size,
        "least": one.quantile(0.0),
        "largest": one.quantile(1.0),
        "quantiles": {f"{share:g}": one.quantile(share) for share in QUANTILES},
        "rank_correlations": dict(one.correlations),
    }


def _worst(one: Worst) -> dict[str, Any]:
    return {
        "simulation": one.simulation,
        "draw": one.draw,
        "margin": one.margin,
        "binding": one.binding,
        "verdict": one.verdict,
        "inputs": dict(one.inputs),
    }


def share_in_words(share: Share, *, random: bool) -> str:
    """12 of 13 (92.3 %; 64.0 to 99.8 %)."""
    if not share.of:
        return "none"
    low, high = share.interval
    span = f"; {100 * low:.1f} to {100 * high:.1f} %" if random else ""
    return f"{share.passed} of {share.of} ({100 * share.value:.1f} %{span})"


def text_of(found: Findings, *, random: bool, wanted: float | None, out: str) -> str:
    """What a person reads."""
    lines = []
    for one in found.controllers:
        failed = f", {one.errors} could not be simulated" if one.errors else ""
        lines.append(f"{name_of(one)}: {share_in_words(one.share, random=random)} pass{failed}")
        limited = [criterion for criterion in one.criteria if criterion.limited]
        width = max((len(criterion.id) for criterion in limited), default=0)
        for criterion in limited:
            share = criterion.share
            middle, high = criterion.quantile(0.5), criterion.quantile(0.99)
            lines.append(
                f"  {criterion.id:<{width}}{100 * share.value:>8.1f} %   median {middle:.4g}, 99 % up to "
                f"{high:.4g} {criterion.unit}"
            )
        if one.worst:
            worst = one.worst[0]
            what = f"simulation {worst.simulation}, {worst.binding}"
            lines.append(f"  worst: {what}, margin {percent(worst.margin)}")
    for words, count in list(found.errors.items())[:3]:
        lines.append(f"{count} with: {words}")
    if wanted is not None:
        reached = "reached" if passed(found, wanted) else "not reached"
        lines.append(f"required pass rate {100 * wanted:g} %: {reached}")
    lines.append(f"{found.simulations} simulations, {_duration(found.processor_s)} of a processor; in {out}")
    return "\n".join(lines)


def _duration(seconds: float) -> str:
    if math.isnan(seconds) or seconds < 120:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.1f} min"
