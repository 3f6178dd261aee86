"""Single simulations of a campaign: from a number to a row of its table."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TypeVar

from hil.analysis.campaigns import Case, inputs_of, varied
from hil.analysis.tuning import Draw, draws_of, with_values
from hil.campaign._execute import Row
from hil.campaign._setting import Setting
from hil.core.channels import CHANNELS
from hil.core.controller import Controller, load_controller
from hil.core.errors import HilError
from hil.core.errors.wording import printable
from hil.core.result import CriterionResult, verdict_of
from hil.engine.prediction.batch_prediction import BatchPrediction
from test_plans import Choices, Plan, judge, plan_from_text
from test_plans.yaml_document import read_yaml

#: Plans and models whose cars are kept, the newest: simulations come in an order in which they change seldom.
_KEPT = 4
_LONGEST_ERROR = 300

T = TypeVar("T")


class Simulations:
    """Carries simulations of a campaign out; what several have in common is made once in each process."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self._plans: OrderedDict[object, tuple[Plan, BatchPrediction]] = OrderedDict()
        self._cars: OrderedDict[object, tuple[Draw, ...]] = OrderedDict()

    @cached_property
    def drawn(self) -> tuple[str, ...]:
        """Columns of what differs from car to car."""
        file = self.setting.file
        if not file.draws:
            return ()
        values = self.setting.cases[0].values  # an effect that is varied stands in each car
        car = varied(self.setting.model, values["model"], values["effect"])
        differs = draws_of(car, file.tolerance, 1, file.seed)[-1].differs
        return tuple(f"effect.{name}" if "." in name else f"model.{name}" for name in differs)

    def rows(self, first: int, last: int) -> list[Row]:
        """Those from `first` to `last`, both included."""
        return [self.row(number) for number in range(first, last + 1)]

    def row(self, number: int) -> Row:
        """One simulation; what goes wrong in it is its row's error, and ends nothing else."""
        begun_s = time.process_time()
        try:
            case = self.setting.cases[number]
            row = {**self._asked(case), **self._carried_out(case)}
        except HilError as error:
            row = self.failed(number, error.what)
        except (ArithmeticError, ValueError) as error:  # numbers that no model holds
            row = self.failed(number, f"{type(error).__name__}: {error}")
        return {**row, "processor_s": time.process_time() - begun_s}

    def made_of(self, number: int) -> tuple[Plan, Draw, Controller | None]:
        """Plan, car and controller of one; None for the controller that the plan itself loads.

        Raises:
            BadInputError: its numbers make no plan, car or controller.
        """
        case = self.setting.cases[number]
        return self._plan(case.values["plan"])[0], self._car(case), self._controller(case)

    def failed(self, number: int, words: str) -> Row:
        """The row of a simulation that could not be executed."""
        asked = self._asked(self.setting.cases[number])
        return {**asked, "verdict": "error", "error": printable(words, _LONGEST_ERROR)}

    def _asked(self, case: Case) -> Row:
        name = self.setting.controllers[case.controller][0]
        row: Row = {"simulation": case.number, "controller": name, "draw": case.draw}
        for group, table in case.values.items():
            row |= {f"{group}.{n}": value for n, value in table.items()}
        return row

    def _carried_out(self, case: Case) -> Row:
        plan, runs = self._plan(case.values["plan"])
        car = self._car(case)
        found = runs(car.model, self._controller(case), car.noise, car.seed)
        criteria = judge(plan, found.recording, found.segments, measured=False, device=False)
        columns = tuple(f"{axis.group}.{axis.name}" for axis in self.setting.cases.axes)
        return {**inputs_of(car.model, (*columns, *self.drawn)), **_of_criteria(criteria)}

    def _plan(self, values: Mapping[str, float]) -> tuple[Plan, BatchPrediction]:
        """The plan with values of its variables, judged by the criteria that count."""
        setting = self.setting

        def made() -> tuple[Plan, BatchPrediction]:
            plan = setting.plan
            if values:
                text = Choices(values=values).applied(plan.text, read_yaml(plan.text, str(plan.source)))
                plan = plan_from_text(text, str(plan.source), plan.source.parent)
            counted = {criterion.id for criterion in setting.criteria}
            kept = tuple(criterion for criterion in plan.criteria if criterion.id in counted)
            plan = plan.model_copy(update={"criteria": kept})
            return plan, BatchPrediction(plan, setting.bench, setting.replaced or Path(), _channels(plan))

        return _kept(self._plans, tuple(values.items()), made)

    def _car(self, case: Case) -> Draw:
        parameters, effects = case.values["model"], case.values["effect"]
        file = self.setting.file

        def made() -> tuple[Draw, ...]:
            model = varied(self.setting.model, parameters, effects)
            return draws_of(model, file.tolerance, file.draws, file.seed)

        return _kept(self._cars, (tuple(parameters.items()), tuple(effects.items())), made)[case.draw]

    def _controller(self, case: Case) -> Controller | None:
        """None: the plan's own file, as it is."""
        given, values = self.setting.controllers[case.controller][1], case.values["controller"]
        if not values:
            return given
        return with_values(given if given is not None else self._own, values)

    @cached_property
    def _own(self) -> Controller:
        assert self.setting.replaced is not None, "axes of a controller are refused without one"
        return load_controller(self.setting.replaced)


def _kept(known: OrderedDict[object, T], key: object, made: Callable[[], T]) -> T:
    if key not in known:
        known[key] = made()
        if len(known) > _KEPT:
            known.popitem(last=False)
    known.move_to_end(key)
    return known[key]


def _channels(plan: Plan) -> frozenset[str]:
    """What the criteria are computed from; all of them where one does not say."""
    names = [getattr(criterion.metric, "channel", None) for criterion in plan.criteria]
    known = [name for name in names if isinstance(name, str)]
    return frozenset(known if len(known) == len(names) else CHANNELS)


def _of_criteria(criteria: tuple[CriterionResult, ...]) -> Row:
    """Values, margins and verdicts, and what the simulation comes to."""
    row: Row = {}
    for one in criteria:
        row |= {
            f"value.{one.id}": one.value,
            f"margin.{one.id}": one.margin,
            f"verdict.{one.id}": one.verdict,
        }
    margins = [one.margin for one in criteria if one.margin is not None]
    troubles = [one.reason for one in criteria if one.verdict in ("error", "not_judged")]
    return {
        **row,
        "verdict": verdict_of(criteria, stopped=False),
        "margin": min(margins, default=None),
        "error": printable(troubles[0], _LONGEST_ERROR) if troubles else None,
    }
