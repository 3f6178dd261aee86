"""Where each number of a model stands in the kernels' parameter vector: the chain, then what effects need.

Each is declared once in a table and gets the next place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from hil.core.chain import KINDS, MEANINGS, RIGID, THREE_INERTIA, TWO_INERTIA, Chain
from hil.core.channels import OUTPUTS
from hil.core.effects import EFFECTS, Effect
from hil.core.errors import BadInputError

if TYPE_CHECKING:
    from hil.core.model import EffectUse, Model


@dataclass(frozen=True)
class Entry:
    """What stands at one place of a vector."""

    name: str
    unit: str
    meaning: str


class Table:
    """Declarations in order. A place is a plain int, which is what the compiler turns into a constant."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def place(self, name: str, unit: str, meaning: str) -> int:
        """Declare one more number; its index.

        Raises:
            ValueError: the name stands in the table.
        """
        if name in self.names:
            raise ValueError(f"'{name}' stands twice")
        self.entries.append(Entry(name, unit, meaning))
        return len(self.entries) - 1

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order of their places."""
        return tuple(entry.name for entry in self.entries)

    def __len__(self) -> int:
        return len(self.entries)


__all__ = ["RIGID", "THREE_INERTIA", "TWO_INERTIA", "pack", "place"]

SLOTS = Table()
for _field in Chain._fields:
    SLOTS.place(_field, *MEANINGS[_field])
#: The slots on which a held step of the linear part depends, the first ones; the others are forces.
CHAIN = len(SLOTS)

(
    KIND,
    MOTOR_INERTIA,
    GEAR_RATIO,
    SHAFT_STIFFNESS,
    SHAFT_DAMPING,
    WHEEL_INERTIA,
    TYRE_STIFFNESS,
    TYRE_DAMPING,
    VEHICLE_INERTIA,
    TORQUE_DELAY,
    LAG,
    DRAG,
    HOUSING_INERTIA,
    MOUNT_STIFFNESS,
    MOUNT_DAMPING,
    WHEEL_RADIUS,
) = range(CHAIN)

#: Effects that the kernels execute, in the order in which they act.
ACTING: tuple[Effect, ...] = tuple(effect for effect in EFFECTS.values() if effect.law.compiled)
#: First slot of each of them; its numbers stand in the order of its parameters.
FIRST: dict[str, int] = {}
for _effect in ACTING:
    FIRST[_effect.id] = len(SLOTS)
    for _parameter in _effect.parameters:
        SLOTS.place(f"{_effect.id}.{_parameter.name}", _parameter.unit, _parameter.meaning)
#: Of wheels that turn as recorded (`_regulated`): a thousand N m for a minute move them by 6e-3 rad/s, and
#: doubles still resolve 1e-7 N m beside what does turn them.
HEAVY_KG_M2 = 1e7
#: Dead time of the torque path before transfer functions that stands for none, s: effects may shorten theirs.
PATH_DELAY_S = 1.0


@cache
def place(effect: str, parameter: str) -> int:
    """The slot of an effect's number.

    Raises:
        ValueError: the kernels have no such number.
    """
    return SLOTS.names.index(f"{effect}.{parameter}")


def _without_effects() -> npt.NDArray[np.float64]:
    vector = np.zeros(len(SLOTS))
    vector[:CHAIN] = Chain()
    for effect in ACTING:
        for name in effect.acting():
            vector[place(effect.id, name)] = effect.off
    vector.setflags(write=False)
    return vector


_PLAIN = _without_effects()


def pack_nothing() -> npt.NDArray[np.float64]:
    """Parameter vector of no model: every number as it is where nothing is given, every effect off."""
    return _PLAIN.copy()


def is_regulated(model: Model) -> bool:
    """Whether the wheels turn as recorded."""
    return bool(model.load_input == OUTPUTS[1])


def pack(model: Model) -> npt.NDArray[np.float64]:
    """Parameter vector of a mechanical model; of a transfer-function model that of its torque path.

    Raises:
        BadInputError: an effect stands twice where the kernel has one place for it.
    """
    vector = _PLAIN.copy()
    chain = Chain()._asdict() | {"wheel_radius_m": model.wheel_radius_m}
    if model.transfer_functions:
        chain["torque_delay"] = PATH_DELAY_S
    else:
        chain["kind"] = KINDS[model.kind]
    chain.update(model.parameters)
    seen: set[str] = set()
    corrections, acting = [], []
    for use in model.effects:
        effect = EFFECTS[use.id]
        if effect.law.reads is not None:
            continue
        if effect.text_parameters:  # a parameter's right value holds whatever else is added
            corrections.append(use)
            continue
        if use.id in seen:
            raise BadInputError(f"effect '{use.id}' stands twice", fix="merge the two [[effects]] tables")
        seen.add(use.id)
        _change(chain, use)
        if use.id in FIRST:
            acting.append(use)
    for use in corrections:
        _change(chain, use)
    if is_regulated(model):
        chain["wheel_inertia" if chain["kind"] == THREE_INERTIA else "vehicle_inertia"] = HEAVY_KG_M2
    numbers = Chain(**chain)
    vector[:CHAIN] = numbers
    for use in acting:
        first, values = FIRST[use.id], _values(use, numbers)
        vector[first : first + len(values)] = values
    return vector


def chain_numbers(model: Model) -> Chain:
    """The linear numbers of a mechanical model, those of its effects included.

    Raises:
        BadInputError: an effect stands twice where the kernel has one place for it.
    """
    return Chain(*pack(model)[:CHAIN].tolist())


def _values(use: EffectUse, chain: Chain) -> tuple[float, ...]:
    effect = EFFECTS[use.id]
    values = tuple(float(use.values.get(p.name, p.default)) for p in effect.parameters)
    return values if effect.law.prepare is None else effect.law.prepare(chain, values)


def _change(chain: dict[str, float], use: EffectUse) -> None:
    change = EFFECTS[use.id].law.chain
    if change is not None:
        values: Mapping[str, float | str] = use.values
        change(chain, values)
