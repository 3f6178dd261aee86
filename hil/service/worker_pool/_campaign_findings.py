"""What a campaign that is over came to, to be drawn: from its `campaign.json` and its table."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from hil.core.errors import BadInputError
from hil.core.files import read_text
from hil.service.worker_pool.drawn_numbers import number

_MOST_CLASSES = 40


def findings(summary: str, table: str) -> dict[str, Any]:
    """Fields of `CampaignFindings` from the paths of both files.

    Raises:
        BadInputError: one of them cannot be read.
    """
    found = json.loads(read_text(Path(summary)))
    ids = dict.fromkeys(one["id"] for of in found["controllers"] for one in of["criteria"])
    rows = _rows(Path(table), ("controller", *(f"value.{one}" for one in ids)))
    return {
        "inputs": found["inputs"],
        "controllers": [
            _of_controller(one, rows[rows["controller"] == one["controller"]]) for one in found["controllers"]
        ],
        "errors": found["errors"],
    }


def _rows(path: Path, columns: Iterable[str]) -> pd.DataFrame:
    try:
        return pd.read_parquet(path, columns=list(columns))
    except (OSError, ValueError, KeyError) as error:
        raise BadInputError(f"cannot be read: {error}", where=path.name) from error


def _of_controller(of: dict[str, Any], rows: pd.DataFrame) -> dict[str, Any]:
    criteria = [
        _of_criterion(one, rows[f"value.{one['id']}"].dropna().to_numpy(float)) for one in of["criteria"]
    ]
    return {**{name: of[name] for name in ("controller", "errors", "worst")}, "criteria": criteria}


def _of_criterion(of: dict[str, Any], values: npt.NDArray[np.float64]) -> dict[str, Any]:
    return {
        **{name: of[name] for name in ("id", "unit", "upper", "lower")},
        "below": of["below"] or "",
        "share": None if of["share"] is None else number(of["share"]["share"]),
        "median": number(float(np.median(values))) if values.size else None,
        "least": number(float(values.min())) if values.size else None,
        "largest": number(float(values.max())) if values.size else None,
        "histogram": histogram(values),
        "rank_correlations": {name: number(one) for name, one in of["rank_correlations"].items()},
    }


def histogram(values: npt.NDArray[np.float64]) -> dict[str, Any] | None:
    """Counts in 40 equal classes at most, as wide as Freedman and Diaconis (1981) say; None of none."""
    if not values.size:
        return None
    edges = np.histogram_bin_edges(values, "fd")
    if len(edges) > _MOST_CLASSES + 1:
        edges = np.linspace(values.min(), values.max(), _MOST_CLASSES + 1)
    counts, edges = np.histogram(values, edges)
    return {"start": float(edges[0]), "width": float(edges[1] - edges[0]), "counts": counts.tolist()}
