"""The best run of those that passed the same criteria, of what the database has of them."""

from __future__ import annotations

import json
from typing import Any

from hil.core.result import CriterionResult
from hil.service.best_run import best_run


def best(run: int, passed: bool, criteria: str) -> dict[str, Any]:
    """Number, margin and criterion of the best run, and among how many; the number is None if there is none.

    Args:
        run: the run whose criteria count.
        passed: whether that run is one of those that passed.
        criteria: `RunList.criteria_beside`.
    """
    found = {
        int(number): [CriterionResult.model_validate(one) for one in judged]
        for number, judged in json.loads(criteria).items()
    }
    wanted = found[run] if passed else found.pop(run)
    one, among = best_run(wanted, found)
    if one is None:
        return {"run": None, "among": among}
    return {"run": one.run, "margin": one.margin, "criterion": one.criterion, "among": among}
