"""The best run of those that passed the same criteria, of what the database has of them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from hil.core.result import CriterionResult
from hil.service.best_run import Setting, best_run


def best(run: int, passed: bool, criteria: str, usual: Mapping[str, Mapping[str, float]]) -> dict[str, Any]:
    """Number, margin and criterion of the best run, and among how many; the number is None if there is none.

    Runs of the same plan with the same values come before better ones, then those of the same bench; the run
    itself counts with the nearest of the others. `other_values` are those of the best run that are not the
    run's own.

    Args:
        run: the run whose criteria count.
        passed: whether that run is one of those that passed.
        criteria: `RunList.criteria_beside`.
        usual: values that plans have by themselves, by the plans' names.
    """
    beside = json.loads(criteria)
    found = {
        int(number): [CriterionResult.model_validate(one) for one in judged]
        for number, judged in beside["criteria"].items()
    }
    settings = {
        int(number): Setting(plan, bench, {**usual.get(plan, {}), **json.loads(values)})
        for number, (plan, bench, values) in beside["settings"].items()
    }
    mine, wanted = settings[run], found.pop(run)
    nearness = {number: setting.nearness_to(mine) for number, setting in settings.items()}
    one, among = best_run(wanted, found, nearness.__getitem__)
    if passed:
        nearness[run] = 0 if one is None else nearness[one.run]
        one, among = best_run(wanted, {run: wanted, **found}, nearness.__getitem__)
    if one is None:
        return {"run": None, "among": among}
    values = {
        name: value for name, value in settings[one.run].values.items() if mine.values.get(name) != value
    }
    return {
        "run": one.run,
        "margin": one.margin,
        "criterion": one.criterion,
        "among": among,
        "other_values": values,
    }
