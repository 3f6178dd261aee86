"""Frame layouts of CANopen PDOs, from the mapping objects of an EDS."""

from __future__ import annotations

from typing import Any

from hil.core.errors import BadInputError
from hil.core.signals import FrameLayout, Signal

_SIGNED = {2, 3, 4, 0x15}
_FLOATS = {8, 0x11}


def layout_of_pdo(dictionary: Any, mapping_index: int, frame_id: int) -> FrameLayout:
    """Layout of the PDO that `mapping_index` (0x1600…, 0x1A00…) maps; `dictionary` is canopen's.

    Signals take the names, factors and units of the mapped objects.

    Raises:
        BadInputError: the EDS has no such mapping, or it maps an object that the EDS does not have.
    """
    where = f"EDS object 0x{mapping_index:04X}"
    if mapping_index not in dictionary:
        raise BadInputError("is missing", where=where, fix="use an EDS that maps the measured values to PDOs")
    signals: dict[str, Signal] = {}
    shift = 0
    for subindex, entry in sorted(dictionary[mapping_index].subindices.items()):
        if subindex == 0 or not entry.default:
            continue
        index, length = entry.default >> 16, entry.default & 0xFF
        if index not in dictionary:
            raise BadInputError(f"maps 0x{index:04X}, which the EDS does not have", where=where)
        mapped = dictionary[index]
        signals[mapped.name] = Signal(
            mapped.name,
            shift,
            length,
            mapped.data_type in _SIGNED,
            float(mapped.factor),
            0.0,
            mapped.unit,
            mapped.data_type in _FLOATS,
        )
        shift += length
    return FrameLayout(f"PDO 0x{mapping_index:04X}", frame_id, (shift + 7) // 8, signals)
