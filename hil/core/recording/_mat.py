"""MATLAB's MAT files (level 5, `save -v7`): one column vector a channel, units beside them."""

from __future__ import annotations

import os
import re
import warnings
import zlib
from collections.abc import Collection, Mapping
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
from scipy.io import loadmat, savemat

from hil.core.channels import CHANNELS, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.files import refuse_unless_regular, replacing
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._evidence import evidence_of, has_evidence, take_evidence
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._table import LARGEST_VALUES, Array, Recording, refuse_too_large

_EVIDENCE, _UNITS = "hil_recording", "units"
_HDF5 = b"\x89HDF\r\n\x1a\n"
_HEAD_BYTES, _COMPRESSED, _BLOCK_BYTES = 128, 15, 1 << 20
_LONGEST_NAME = 63  # of a variable in MATLAB
_LEVEL_7_3 = 512  # bytes of its own that MATLAB puts before HDF5


def read_mat(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read a MAT file: vectors of one length, as variables or as the fields of one structure.

    Version 7.3 is HDF5, and read as such.

    Raises:
        BadInputError: no MAT file, a broken one, or a known channel is no vector of real numbers.
    """
    refuse_unless_regular(path)
    if _is_hdf5(path):
        from hil.core.recording._hdf5 import read_hdf5

        return read_hdf5(path, columns)
    _refuse_inflating(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # objects that only MATLAB knows, names that stand twice
            held = loadmat(path, appendmat=False, squeeze_me=False, struct_as_record=True)
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError(
            "not a MAT file, or a broken one",
            where=str(path),
            fix="save it again in MATLAB, or as a CSV file",
        ) from error
    values = {name: value for name, value in held.items() if not name.startswith("__")}
    evidence = _text(values.pop(_EVIDENCE, None))
    units = _units_of(values.pop(_UNITS, None))
    table: dict[str, Column] = {}
    notes: list[str] = []
    vectors = _vectors_of(values, {TIME, *(source.column for _, source in columns.columns())})
    refuse_too_large(max((value.size for value in vectors.values()), default=0), len(vectors), str(path))
    for name, value in vectors.items():
        column = _column(value)
        if column is not None:
            table[name] = Column(column, units.get(name, ""))
        elif name in CHANNELS:
            raise BadInputError(
                "is not a vector of real numbers",
                where=f"{path}: variable '{name}'",
                fix="save it as a vector of doubles in the unit of its name",
            )
        else:
            notes.append(f"variable '{name}' is not a vector of real numbers and was left out")
    recording = recording_of(table, path, columns, "variable", notes, own=evidence is not None)
    if evidence is not None:
        take_evidence(recording, evidence, f"its variable '{_EVIDENCE}'")
    return recording


def write_mat(recording: Recording, path: Path) -> None:
    """Write level 5: a column vector a channel, a structure `units`, and what stands beside as JSON text.

    Raises:
        BadInputError: two channels would have one name in MATLAB.
    """
    names: dict[str, str] = {}
    for channel in recording.channels:
        name = _valid(channel)
        if name in names:
            raise BadInputError(
                f"'{names[name]}' and '{channel}' are one name in MATLAB: '{name}'",
                where=str(recording.source),
                fix="rename one of the two columns",
            )
        names[name] = channel
    with replacing(path) as temporary:
        savemat(
            temporary,
            _Variables(recording, names),
            appendmat=False,
            do_compression=True,
            long_field_names=True,
            oned_as="column",
        )


class _Variables(dict[str, Any]):
    """The variables of a recording; channels are read as they are written, so that few are held."""

    def __init__(self, recording: Recording, names: Mapping[str, str]) -> None:
        further: dict[str, Any] = {_UNITS: {name: unit_of(channel) for name, channel in names.items()}}
        if has_evidence(recording):
            further[_EVIDENCE] = evidence_of(recording)
        super().__init__(further)
        self._recording, self._names = recording, names

    def items(self) -> Any:
        """Name and value of every variable."""
        columns = self._recording.columns(list(self._names.values()))
        named = zip(self._names, (values for _, values in columns), strict=True)
        return chain(named, super().items())


def _is_hdf5(path: Path) -> bool:
    """Whether a file is HDF5, as MATLAB's version 7.3 is."""
    with path.open("rb") as file:
        beginning = file.read(_LEVEL_7_3 + len(_HDF5))
    return beginning.startswith(_HDF5) or beginning[_LEVEL_7_3:] == _HDF5


def _refuse_inflating(path: Path) -> None:
    """Refuse compressed variables of more bytes than are read at once, before they are held.

    Raises:
        BadInputError: they are that large. What else is wrong with a file its reader says.
    """
    most = LARGEST_VALUES * np.float64().nbytes
    inflated = 0
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
        order: Literal["little", "big"] = "big" if head[-2:] == b"MI" else "little"
        while len(tag := file.read(8)) == 8:
            kind, size = int.from_bytes(tag[:4], order), int.from_bytes(tag[4:], order)
            if kind != _COMPRESSED:
                file.seek(size, os.SEEK_CUR)
                continue
            inflated += _inflated_bytes(file, size, most - inflated)
            if inflated > most:
                raise BadInputError(
                    f"holds more than {most / 1e9:g} GB, packed into {path.stat().st_size / 1e6:.3g} MB",
                    where=str(path),
                    fix="save fewer samples, or cut it into pieces",
                )


def _inflated_bytes(file: BinaryIO, size: int, most: int) -> int:
    """Bytes of a compressed element of `size` bytes, counted until they are more than `most`."""
    unpacking, count = zlib.decompressobj(), 0
    while size > 0 and count <= most and (packed := file.read(min(size, _BLOCK_BYTES))):
        size -= len(packed)
        try:
            while packed and count <= most:
                count += len(unpacking.decompress(packed, _BLOCK_BYTES))
                packed = unpacking.unconsumed_tail
        except zlib.error:
            break
    file.seek(max(size, 0), os.SEEK_CUR)
    return count


def _vectors_of(values: dict[str, Any], named: Collection[str]) -> Mapping[str, Any]:
    """The variables; where one structure alone holds the time, or a column of the map, its fields."""
    if any(name in values for name in named):
        return values
    holding = [v for v in values.values() if _is_structure(v) and set(named) & set(v.dtype.names)]
    if len(holding) != 1:
        return values
    return {name: holding[0][name][0, 0] for name in holding[0].dtype.names}


def _is_structure(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype.names is not None and value.shape == (1, 1)


def _column(value: Any) -> Array | None:
    """A vector of real numbers as doubles."""
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiub" or value.size != max(value.shape):
        return None
    return np.ascontiguousarray(value.reshape(-1), dtype=np.float64)


def _units_of(value: Any) -> dict[str, str]:
    """Units by name, of the structure `units`; none where there is no such structure."""
    if not _is_structure(value):
        return {}
    found = {name: _text(value[name][0, 0]) for name in value.dtype.names}
    return {name: text for name, text in found.items() if text is not None}


def _text(value: Any) -> str | None:
    if isinstance(value, np.ndarray) and value.dtype.kind == "U" and value.size == 1:
        return str(value.reshape(-1)[0])
    return None


def _valid(name: str) -> str:
    """A name that MATLAB takes, as its own makeValidName has it."""
    plain = re.sub(r"[^0-9A-Za-z_]", "_", name)
    if not plain[:1].isalpha():
        plain = f"x{plain}"
    return plain[:_LONGEST_NAME]
