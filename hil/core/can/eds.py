"""An EDS, and the frame layouts of the CANopen PDOs that its mapping objects describe."""

from __future__ import annotations

import io
import logging
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from canopen.objectdictionary import ODVariable
from canopen.objectdictionary.eds import import_eds

from hil.core.can.signals import FrameLayout, Signal
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.core.files import read_device_text

ObjectDictionary = Any  # canopen's, which has no types
Place = tuple[int, int]  # index and subindex of an object

# CANopen's data types (CiA 301), with their bits
_SIGNED = {2: 8, 3: 16, 0x10: 24, 4: 32, 0x12: 40, 0x13: 48, 0x14: 56, 0x15: 64}
_UNSIGNED = {1: 1, 5: 8, 6: 16, 0x16: 24, 7: 32, 0x18: 40, 0x19: 48, 0x1A: 56, 0x1B: 64}
_FLOATS = {8: 32, 0x11: 64}
_BITS = _SIGNED | _UNSIGNED | _FLOATS
_FIRST_OBJECT = 0x1000  # below are the types, which a mapping uses for gaps
_LARGEST_BITS = 64
_SWITCHED_OFF, _EXTENDED, _LARGEST_ID = 1 << 31, 1 << 29, 0x7FF  # of a COB-ID
#: A number of the file's head with zeros before it, which CiA 306 allows and the parser does not.
_LEADING_ZEROS = re.compile(r"(?m)^([ \t]*[A-Za-z_0-9]+[ \t]*=[ \t]*)0+([0-9]+)[ \t]*\r?$")
_FIX = "correct the EDS; benches/rcs_dyno.eds is an example"

# What the parser finds odd it also logs; what matters of it is refused here.
logging.getLogger("canopen.objectdictionary.eds").addHandler(logging.NullHandler())


def read_eds(
    path: Path, node_id: int, objects: Sequence[Place], floats: Sequence[Place] = ()
) -> ObjectDictionary:
    """canopen's object dictionary of a node; `objects` must be in it as numbers, `floats` as IEEE floats.

    Raises:
        BadInputError: not an EDS, or an object is missing: file and object.
    """
    text = read_device_text(path, "check [dyno] eds")
    try:
        dictionary = import_eds(io.StringIO(_without_leading_zeros(text)), node_id)
    except Exception as error:  # the parser raises whatever it stumbles over
        words = str(error).partition("\n")[0]
        raise BadInputError(
            f"not an EDS file: {printable(words, 200)}", where=str(path), fix="give the dynos' EDS"
        ) from error
    if not len(dictionary):
        raise BadInputError("not an EDS file: has no objects", where=str(path), fix="give the dynos' EDS")
    for index, subindex in (*objects, *floats):
        place, variable = _place(index, subindex), _variable(dictionary, index, subindex)
        if variable is None:
            raise BadInputError(f"has no object {place}", where=str(path), fix=_FIX)
        if variable.data_type not in _BITS:
            raise BadInputError(f"object {place} is not a number", where=str(path), fix=_FIX)
        if (index, subindex) in floats and variable.data_type not in _FLOATS:
            raise BadInputError(f"object {place} is no IEEE float (REAL32)", where=str(path), fix=_FIX)
    return dictionary


def _without_leading_zeros(text: str) -> str:
    """The file with plain numbers in its section DeviceInfo, which nothing here needs."""
    head = re.search(r"(?ims)^\[DeviceInfo\].*?(?=^\[|\Z)", text)
    if head is None:
        return text
    return text[: head.start()] + _LEADING_ZEROS.sub(r"\1\2", head[0]) + text[head.end() :]


def layout_of_pdo(
    dictionary: ObjectDictionary,
    mapping_index: int,
    frame_id: int,
    needed: Sequence[str] = (),
    where: str = "EDS",
) -> FrameLayout:
    """Layout of the PDO that `mapping_index` (0x1600…, 0x1A00…) maps; `dictionary` is canopen's.

    Signals take the names, factors and units of the mapped objects.

    Raises:
        BadInputError: the EDS has no such mapping, it maps what the EDS does not have or what does not fit
            into a frame, or a signal that is `needed` is not mapped.
    """
    where = f"{where}, object 0x{mapping_index:04X}"
    signals: dict[str, Signal] = {}
    shift = 0
    for mapping in mapping_of(dictionary, mapping_index, where):
        index, subindex, length = mapping >> 16, mapping >> 8 & 0xFF, mapping & 0xFF
        if index >= _FIRST_OBJECT:
            mapped = _variable(dictionary, index, subindex)
            if mapped is None:
                raise BadInputError(
                    f"maps {_place(index, subindex)}, which the EDS does not have", where=where, fix=_FIX
                )
            signal = _signal(mapped, shift, length, where)
            signals[signal.name] = signal
        shift += length
    if shift > _LARGEST_BITS:
        raise BadInputError(f"maps {shift} bits; a frame has {_LARGEST_BITS}", where=where, fix=_FIX)
    for name in needed:
        if name not in signals:
            raise BadInputError(
                f"does not map '{name}'",
                where=where,
                fix="use an EDS that maps it; names are those of the EDS",
            )
    return FrameLayout(f"PDO 0x{mapping_index:04X}", frame_id, (shift + 7) // 8, signals)


def mapping_of(dictionary: ObjectDictionary, mapping_index: int, where: str) -> list[int]:
    """The mapping's entries: index, subindex and length in bits, in one number each.

    Raises:
        BadInputError: one of them is missing, no whole number, or 0: which would move all behind it.
    """
    if mapping_index not in dictionary:
        raise BadInputError("is missing", where=where, fix="use an EDS that maps the measured values to PDOs")
    subindices = getattr(dictionary[mapping_index], "subindices", None)
    if not subindices:
        raise BadInputError("maps nothing", where=where, fix=_FIX)
    count = _number(subindices.get(0), f"{where} sub 0", what="the number of mapped objects")
    if count is None:
        count = max(subindices)
    entries = []
    for subindex in range(1, count + 1):
        place = f"{where} sub {subindex}"
        entry = _number(subindices.get(subindex), place, what="a mapped object")
        if not entry:
            words = "is 0 and maps nothing" if entry == 0 else "has no value"
            raise BadInputError(words, where=place, fix=f"{_FIX}; sub 0 says how many objects are mapped")
        entries.append(entry)
    return entries


def identifier_of(dictionary: ObjectDictionary, communication_index: int, usual: int, where: str) -> int:
    """Under which identifier a PDO is sent, from its communication parameter (0x1400…, 0x1800…) sub 1.

    Args:
        usual: where the EDS does not say.

    Raises:
        BadInputError: the PDO is switched off (bit 31), or its identifier has 29 bits.
    """
    where = f"{where}, object 0x{communication_index:04X} sub 1"
    found = _number(_variable(dictionary, communication_index, 1), where, what="the COB-ID")
    if found is None:
        return usual
    if found & _SWITCHED_OFF:
        raise BadInputError(
            f"the COB-ID is 0x{found:08X}: the PDO is switched off (bit 31)",
            where=where,
            fix="use an EDS or DCF in which it is valid, as the device has it",
        )
    if found & _EXTENDED or found & 0x1FFF_FFFF > _LARGEST_ID:
        raise BadInputError(
            f"the COB-ID is 0x{found:08X}, of 29 bits", where=where, fix="the bench's frames have 11 bits"
        )
    return int(found & _LARGEST_ID)


def _number(variable: Any, where: str, *, what: str) -> int | None:
    """What a file says: `ParameterValue` of a DCF, else `DefaultValue`; None if it says nothing.

    Raises:
        BadInputError: something stands there that is no whole number.
    """
    if variable is None:
        return None
    for raw, value in (("value_raw", "value"), ("default_raw", "default")):
        text = getattr(variable, raw, None)
        if text is None or not str(text).strip():
            continue
        number = getattr(variable, value, None)
        if not isinstance(number, int):
            words = f"{what} is '{printable(str(text), 40)}', no whole number"
            raise BadInputError(words, where=where, fix=_FIX)
        return number
    found = getattr(variable, "default", None)
    return found if isinstance(found, int) else None


def _signal(mapped: Any, shift: int, length: int, where: str) -> Signal:
    name, factor = printable(mapped.name), float(mapped.factor)
    bits = _BITS.get(mapped.data_type)
    if bits != length:
        raise BadInputError(
            f"maps {length} bits of '{name}', which " + (f"has {bits}" if bits else "is no number"),
            where=where,
            fix=_FIX,
        )
    if factor == 0 or not math.isfinite(factor):
        raise BadInputError(
            f"'{name}' has the factor {factor:g}: its bits give no value", where=where, fix=_FIX
        )
    return Signal(
        name,
        shift,
        length,
        mapped.data_type in _SIGNED,
        factor,
        0.0,
        printable(mapped.unit),
        mapped.data_type in _FLOATS,
    )


def _variable(dictionary: ObjectDictionary, index: int, subindex: int) -> Any | None:
    if index not in dictionary:
        return None
    entry = dictionary[index]
    if isinstance(entry, ODVariable):
        return entry if subindex == 0 else None
    return entry[subindex] if subindex in entry.subindices else None


def _place(index: int, subindex: int) -> str:
    return f"0x{index:04X}" + (f" sub {subindex}" if subindex else "")
