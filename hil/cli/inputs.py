"""What the options of a command choose: values, controllers, bench, and the request of a use case."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import fields
from typing import Any, TypeVar

from hil.app.series import LARGEST_SERIES
from hil.cli.streams import complain
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.engine import DEFAULT_BENCH
from hil.engine.bench.bench_file import folders_of, found_bench, refuse_hardware
from test_plans import Choices, controller_choices
from test_plans.yaml_document import FLOAT


def named_values(given: Iterable[str], option: str, *, form: str = "NAME=VALUE") -> dict[str, str]:
    """Values by name, in the order given.

    Args:
        form: what is to be written, for the message.

    Raises:
        BadInputError: no '=' in it, or a name stands twice.
    """
    values: dict[str, str] = {}
    for text in given:
        name, sign, value = text.partition("=")
        if not sign:
            raise BadInputError(f"'{printable(text)}' has no '='", where=option, fix=f"write {option} {form}")
        name = name.strip()
        if name in values:
            raise BadInputError(
                f"'{printable(name)}' is given twice", where=option, fix=f"give {option} once for each name"
            )
        values[name] = value.strip()
    return values


def named_numbers(given: Iterable[str], option: str) -> dict[str, float]:
    """Numbers by name.

    Raises:
        BadInputError: not NAME=VALUE, a name stands twice, or the value is no number.
    """
    numbers = {}
    for name, value in named_values(given, option).items():
        number = number_of(value)
        if number is None:
            raise BadInputError(
                f"'{printable(f'{name}={value}')}' has no number behind '='",
                where=option,
                fix=f"write {option} NAME=VALUE",
            )
        numbers[name] = number
    return numbers


def number_of(text: str) -> float | None:
    """A finite number as a plan would write it; None of anything else."""
    number = float(text) if FLOAT.fullmatch(text) else math.inf
    return number if math.isfinite(number) else None


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


R = TypeVar("R")


def request_of(kind: type[R], options: object, **given: Any) -> R:
    """A request of which each field is the option of the same name, unless it is given."""
    names = {field.name for field in fields(kind)}  # type: ignore[arg-type]
    return kind(**{name: getattr(options, name) for name in names - given.keys()}, **given)
