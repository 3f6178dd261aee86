"""What the options of a command choose for runs: values of the plan, controllers, and the bench."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from hil.app.series import LARGEST_SERIES
from hil.cli.inputs import named_values, number_of
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.engine import DEFAULT_BENCH
from hil.engine.bench.bench_file import folders_of, found_bench, refuse_hardware
from test_plans import Choices, controller_choices

_OPTION = "--set"


def choices_of(values: list[str] | None, controller: list[str] | None) -> Choices:
    """The only choice.

    Raises:
        BadInputError: no number, several numbers, no such file.
    """
    found = list(all_choices(values, controller))
    if len(found) > 1:
        raise BadInputError("has several values", where=_OPTION, fix="give one; `hil run` takes several")
    return found[0]


def all_choices(values: list[str] | None, controller: list[str] | None) -> Iterator[Choices]:
    """Every combination of the values, in the order given; one choice where nothing has several.

    Raises:
        BadInputError: no number, or no such file.
    """
    controllers = controller_choices(controller or [], "--controller")
    named = named_values(values or (), _OPTION, form="NAME=VALUE")
    several = {name: [_number(name, one) for one in text.split(",")] for name, text in named.items()}
    runs = math.prod(len(numbers) for numbers in several.values())
    if runs > LARGEST_SERIES:
        raise BadInputError(
            f"the values make {runs} combinations, at most {LARGEST_SERIES} runs are executed",
            where=_OPTION,
            fix="give fewer values, or simulate them with `hil campaign`",
        )
    for combination in itertools.product(*several.values()):
        yield Choices(controllers, dict(zip(several, combination, strict=True)))


def _number(name: str, text: str) -> float:
    value = number_of(text.strip())
    if value is None:
        raise BadInputError(
            f"{printable(name, 60)} = '{printable(text, 60)}' is not a number",
            where=_OPTION,
            fix="write NAME=VALUE, with a decimal point and without a unit",
        )
    return value


def bench_or_own(given: str, plan: str | None = None, *, drives: bool = False) -> str:
    """The bench that is given, else the `bench.toml` beside the plan or in the current folder, else `sim`.

    Args:
        given: file or name; '' if none is.
        plan: file or name.
        drives: whether the command moves what is at the bench: hardware must be named then.

    Raises:
        BadInputError: a bench.toml was found that cannot be used, or that describes hardware.
    """
    if given:
        return given
    found = found_bench(folders_of(plan))
    if found is None:
        return DEFAULT_BENCH
    if drives:
        refuse_hardware(found)
    complain("note", f"the bench is {found}; --bench names another")
    return str(found)
