"""What an effect is: the one object that simulation, model files, diagnosis, docs and reports read."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Literal

from hil.core.channels import OUTPUTS
from hil.core.effects._law import Law
from hil.core.effects._probe import Probes
from hil.core.errors import BadInputError
from hil.core.errors.mistakes import Mistakes
from hil.core.errors.wording import closest, did_you_mean

#: What a model gives, and so what a sensor effect can bend.
SENSED = ("motor_torque_nm", *OUTPUTS)
_MOST_SHOWN = 60


def finite_number(value: object) -> float | None:
    """`value` as a float; None where it is no plain finite number (an integer may be beyond floats)."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def shown(value: object) -> str:
    """A value from a file as a message shows it: whole if short."""
    try:
        text = repr(value)
    except ValueError:  # an integer of more digits than Python prints
        return "a number of thousands of digits"
    return text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."


class Stage(Enum):
    """Where along the way from torque request to recorded channel an effect enters."""

    TORQUE_PATH = "torque path"
    SHAFT = "drive shafts"
    ROTOR = "rotor"
    HOUSING = "housing"
    TYRE = "tyre and road"
    LOAD = "load"
    SENSOR = "sensor"
    MODEL = "model"


@dataclass(frozen=True)
class Parameter:
    """One number of an effect: unit in SI, the interval in which it makes sense, and how a fit moves it.

    Args:
        optional: may be left out, and then is `default`.
        typical: size of a small change; None: it is moved by its logarithm, and is never zero.
        step: of a finite difference, times the usual one.
        within: how far a fit may go, where that is not from `lower` to `upper`.
        fitted: whether a fit may move it.
        opens: an optional number is tried from these values once its effect is found; those of a torque are
            shares of the largest one that was asked for.
        rough: errors are rough in it, since contact comes and goes.
        choices: values between which a diagnosis chooses, for a number that no fit moves.
        beside: optional numbers of which one must be there: without, it means little or nothing.
    """

    name: str
    unit: str
    lower: float
    upper: float
    meaning: str
    optional: bool = False
    default: float = 0.0
    typical: float | None = None
    step: float = 1.0
    within: tuple[float, float] | None = None
    fitted: bool = True
    opens: tuple[float, ...] = ()
    rough: bool = False
    choices: tuple[float, ...] = ()
    beside: tuple[str, ...] = ()


@dataclass(frozen=True)
class Least:
    """The smallest size of an effect that is worth a name: what a bench's instruments are good to.

    `amount` counts from where the effect does nothing (`off`) in the unit of its first acting number, or in
    samples, in largest torque requests, or in rms readings of its channel.
    """

    amount: float
    of: Literal["", "samples", "largest torque", "rms reading"] = ""


@dataclass(frozen=True)
class Memory:
    """The number that an effect keeps from step to step."""

    unit: str
    meaning: str


@dataclass(frozen=True)
class Effect:
    """One physical effect: all that anything in the house knows about it (docs/how-to/own-effect.md).

    Args:
        id: its name in model files and diagnoses.
        title: the same for people.
        stage: where it enters.
        summary: what it is; signature: what it looks like in data; shown_by: which experiment shows it.
        source: where its law is from.
        parameters: its numbers; with all of those that `sizes` names (the first one when left out) at
            `off`, it does nothing.
        text_parameters: parameters whose value is a name (a channel, a model parameter).
        needs: the model kinds that it can be added to.
        makes: the model kind that a model is with it, where that is another.
        law: how it acts; memory: what it keeps from step to step.
        probes: the sizes that a diagnosis tries first.
        similar: effects that look like it.
        abrupt: errors have false minima in its size: fits are repeated from other sizes.
        least: the smallest size worth naming; None: any that the data prove.
        needs_reversals: recordings in which the axle always turns one way hide it.
        together: why its values make no sense with the other effects of a model, by id, and the remedy; None
            where they do.
        derived: numbers that users know beside the fitted ones: of its values, name (with its unit): number.
    """

    id: str
    title: str
    stage: Stage
    summary: str
    signature: str
    shown_by: str
    parameters: tuple[Parameter, ...]
    text_parameters: tuple[str, ...] = ()
    needs: tuple[str, ...] = ("rigid", "two_inertia", "three_inertia")
    makes: str | None = None
    law: Law = field(default_factory=Law)
    sizes: tuple[str, ...] = ()
    off: float = 0.0
    memory: Memory | None = None
    probes: Probes | None = None
    similar: tuple[str, ...] = ()
    abrupt: bool = False
    least: Least | None = None
    needs_reversals: bool = False
    derived: Callable[[Mapping[str, float]], Mapping[str, float]] | None = None
    together: (
        Callable[[Mapping[str, Any], Mapping[str, Mapping[str, Any]]], tuple[str, str] | None] | None
    ) = None
    source: str = ""

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name.

        Raises:
            KeyError: there is none.
        """
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)

    def acting(self) -> tuple[str, ...]:
        """Names of the numbers that are all at `off` where the effect does nothing."""
        return self.sizes or (self.parameters[0].name,)

    def acting_with(self, opened: Collection[str] = ()) -> list[str]:
        """Those of them that are not optional, or `opened`."""
        return [name for name in self.acting() if name in opened or not self.parameter(name).optional]

    def completed(self, values: Mapping[str, float | str]) -> dict[str, float | str]:
        """`values`, which need not give optional numbers, with the defaults of those."""
        return {p.name: p.default for p in self.parameters if p.optional} | dict(values)

    def label(self, values: Mapping[str, object]) -> str:
        """The effect's name, with the channel or parameter that it is about."""
        about = [str(values[name]) for name in self.text_parameters if name in values]
        return f"{self.id}({', '.join(about)})" if about else self.id

    def check(self, values: Mapping[str, object], where: str) -> dict[str, float | str]:
        """Return `values` complete with defaults.

        Raises:
            BadInputError: every unknown or missing key, not a number, or out of the parameter's
                bounds; a channel that no model gives.
        """
        known = {p.name for p in self.parameters} | set(self.text_parameters)
        mistakes = Mistakes()
        for key in values:
            if key not in known:
                with mistakes.of(key):
                    raise BadInputError(
                        f"effect '{self.id}' has no parameter '{key}'", fix=did_you_mean(key, sorted(known))
                    )
        complete: dict[str, float | str] = {}
        for name in self.text_parameters:
            with mistakes.of(name):
                complete[name] = self._text(name, values.get(name))
        meant = {closest(key, known) for key in values if key not in known}
        for parameter in self.parameters:
            if parameter.name not in values and parameter.name in meant:  # its misspelling has been reported
                continue
            with mistakes.of(parameter.name):
                complete[parameter.name] = self._number(parameter, values.get(parameter.name))
        mistakes.refuse(where)
        return complete

    def _text(self, name: str, value: object) -> str:
        if not isinstance(value, str) or not value:
            raise BadInputError(f"effect '{self.id}' needs '{name}', a name")
        if name == "channel" and value not in SENSED:
            raise BadInputError(
                f"effect '{self.id}': a model has no channel {shown(value)}", fix=did_you_mean(value, SENSED)
            )
        return value

    def _number(self, parameter: Parameter, value: object) -> float:
        if value is None and parameter.optional:
            return parameter.default
        if value is None:
            raise BadInputError(f"effect '{self.id}' needs '{parameter.name}' ({parameter.unit})")
        number = finite_number(value)
        if number is None:
            raise BadInputError(
                f"effect '{self.id}': '{parameter.name}' is {shown(value)}, not a finite number",
                fix=f"give a plain number in {parameter.unit or 'no unit'}",
            )
        if not parameter.lower <= number <= parameter.upper:
            raise BadInputError(
                f"effect '{self.id}': '{parameter.name}' = {number:g} {parameter.unit} is out of range",
                fix=f"it lies from {parameter.lower:g} to {parameter.upper:g} {parameter.unit}",
            )
        return number
