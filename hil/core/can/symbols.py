"""Where a control unit keeps its variables: symbols, as a file of them says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError
from hil.core.errors.wording import did_you_mean, printable
from hil.core.units import UnitError, conversion, has_unit

#: Data types by their names in A2L files, as numpy calls them without their byte order.
TYPES = {
    "UBYTE": "u1",
    "SBYTE": "i1",
    "UWORD": "u2",
    "SWORD": "i2",
    "ULONG": "u4",
    "SLONG": "i4",
    "A_UINT64": "u8",
    "A_INT64": "i8",
    "FLOAT32_IEEE": "f4",
    "FLOAT64_IEEE": "f8",
}
_LARGEST_ID = 0x7FF


@dataclass(frozen=True)
class Symbol:
    """A variable: its value is raw * scale + offset, in `unit`.

    `kind`: numpy's name of its type without byte order; `order`: "<", ">", or "" as the control unit counts;
    `unusable`: why it cannot be measured, '' if it can.
    """

    name: str
    address: int
    kind: str
    unit: str = ""
    scale: float = 1.0
    offset: float = 0.0
    extension: int = 0
    order: str = ""
    unusable: str = ""

    @property
    def size(self) -> int:
        """Bytes that it takes."""
        return np.dtype(self.kind).itemsize

    def in_unit(self, wanted: str, where: str) -> Symbol:
        """The same symbol with values in another unit; one that says no unit is taken to be in it.

        Args:
            wanted: '' if none is.
            where: its file, for messages.

        Raises:
            BadInputError: its unit is not known, or is of another quantity.
        """
        if not wanted or not has_unit(self.unit):
            return self
        try:
            found = conversion(self.unit, wanted)
        except UnitError as error:
            what = f"symbol '{printable(self.name, 60)}' {error.what}"
            raise BadInputError(what, where=where, fix=error.fix) from None
        if found.is_none:
            return self
        scale, offset = found.of_line(self.scale, self.offset)
        return replace(self, scale=scale, offset=offset, unit=wanted)

    def dtype(self, order: str) -> np.dtype[np.generic]:
        """Its type in memory, on a control unit that counts in `order`."""
        return np.dtype((self.order or order) + self.kind)

    def raw(self, values: npt.NDArray[np.float64], order: str) -> npt.NDArray[np.uint8]:
        """Values, shape (n,), as they stand in memory, shape (n, size); held at the ends of the type."""
        dtype = self.dtype(order)
        numbers = (values - self.offset) / self.scale
        if dtype.kind in "iu":
            ends = np.iinfo(str(dtype))
            # the largest float below the end: the end itself may round to beyond it
            numbers = np.clip(np.rint(numbers), float(ends.min), np.nextafter(float(ends.max) + 1.0, 0.0))
        return numbers.astype(dtype).view(np.uint8).reshape(len(values), -1)

    def values(self, raw: npt.NDArray[np.uint8], order: str) -> npt.NDArray[np.float64]:
        """What memory, shape (n, size), says, shape (n,)."""
        numbers = np.ascontiguousarray(raw).view(self.dtype(order))[:, 0].astype(np.float64)
        return numbers * self.scale + self.offset


@dataclass(frozen=True)
class Symbols:
    """All symbols of a file, and what else it says of the control unit.

    Attributes:
        by_name: the symbols.
        order: byte order, "<" or ">"; '' if the file does not say.
        request_id, answer_id: identifiers of XCP on CAN; None if the file does not say.
        software: what identifies the software that the addresses are of, '' if nothing does.
        software_address: where that text stands in memory.
    """

    by_name: Mapping[str, Symbol]
    order: str = ""
    request_id: int | None = None
    answer_id: int | None = None
    software: str = ""
    software_address: int | None = None
    file: Path = field(default_factory=Path)

    def find(self, name: str) -> Symbol:
        """A symbol that can be measured.

        Raises:
            BadInputError: there is none of that name, or it cannot be measured.
        """
        symbol = self.by_name.get(name)
        if symbol is None:
            raise BadInputError(
                f"has no symbol '{printable(name, 60)}'",
                where=str(self.file),
                fix=did_you_mean(name, self.by_name),
            )
        if symbol.unusable:
            raise BadInputError(
                f"symbol '{printable(name, 60)}' {symbol.unusable}",
                where=str(self.file),
                fix="measure another one, or give the symbols as a CSV table",
            )
        return symbol


def refuse_extended(number: int, what: str, where: str) -> int:
    """An identifier of 11 bits as it is.

    Raises:
        BadInputError: it has more.
    """
    if not 0 <= number <= _LARGEST_ID:
        raise BadInputError(
            f"{what} 0x{number:X} is not an identifier of 11 bits",
            where=where,
            fix="only standard frames are sent: give request_id and answer_id in the bench file",
        )
    return number
