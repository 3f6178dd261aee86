"""HDF5 with h5py: vectors, tables of pandas (`format="fixed"`), and MATLAB's MAT files of version 7.3."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hil.core.channels import CHANNELS, TIME
from hil.core.errors import BadInputError
from hil.core.errors.extras import need
from hil.core.files import refuse_unless_regular
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._table import Recording, refuse_too_large

_MOST_DEEP = 8  # groups inside of groups
_MOST_PACKED = 1000  # values in a byte: what deflate makes of zeros
_UNITS = ("units", "unit", "Unit", "Units")


def read_hdf5(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read the vectors and tables of an HDF5 file; a vector in groups is named by its path.

    Raises:
        BadInputError: h5py is not installed, no HDF5 file or a broken one, or what `recording_of` refuses.
    """
    refuse_unless_regular(path)
    need("h5py", "save it as CSV, Parquet or MAT with -v7")
    import h5py

    notes: list[str] = []
    try:
        with h5py.File(path, "r", locking=False) as file:
            _refuse_pytables(file, path)
            found = list(_vectors(file, "", 0, notes))
            rows = max((size for _, size, _ in found), default=0)
            refuse_too_large(rows, len(found), str(path))
            if sum(size for _, size, _ in found) > _MOST_PACKED * path.stat().st_size:
                raise ValueError("promises more values than its bytes can hold")
            table = {name: read() for name, _, read in found}
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not an HDF5 file, or a broken one", where=str(path)) from error
    return recording_of(_short_names(table), path, columns, "dataset", notes)


def _vectors(group: Any, at: str, deep: int, notes: list[str]) -> Iterator[tuple[str, int, Any]]:
    """Name, length and reader of each vector below a group; none is read yet."""
    if "axis0" in group and "block0_values" in group:
        yield from _of_pandas(group, at)
        return
    for name in group:
        link = group.get(name, getlink=True)
        if type(link).__name__ != "HardLink":
            notes.append(f"'{at}{name}' is a link and was left out")
            continue
        item = group[name]
        if hasattr(item, "keys"):
            if not name.startswith("#") and deep < _MOST_DEEP:  # MATLAB keeps what it refers to in #refs#
                yield from _vectors(item, f"{at}{name}/", deep + 1, notes)
        elif item.dtype.names:
            for part in item.dtype.names:
                if item.ndim == 1 and item.dtype[part].kind in "fiub":
                    yield f"{at}{part}", item.size, _reader(item, part)
        elif item.dtype.kind in "fiub" and item.shape and item.size == max(item.shape):
            yield f"{at}{name}", item.size, _reader(item)
        elif name in CHANNELS:
            raise BadInputError(
                "is not a vector of real numbers", where=f"{group.file.filename}: dataset '{name}'"
            )
        else:
            notes.append(f"dataset '{at}{name}' is not a vector of real numbers and was left out")


def _reader(item: Any, part: str = "") -> Any:
    def read() -> Column:
        whole = np.asarray(item[part] if part else item[()])
        unit = next((item.attrs[key] for key in _UNITS if key in item.attrs), "")
        text = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)
        return Column(np.ascontiguousarray(whole.reshape(-1), np.float64), "" if part else text)

    return read


def _of_pandas(group: Any, at: str) -> Iterator[tuple[str, int, Any]]:
    """Columns and index of a DataFrame that pandas wrote with `format="fixed"`."""

    def read(block: str, number: int) -> Any:
        return lambda: Column(np.asarray(group[f"{block}_values"][:, number], np.float64))

    kind = _decoded(group["axis1"].attrs.get("kind", b""))
    is_moment = kind.startswith(("datetime64", "timedelta64"))

    def index() -> Column:
        values = group["axis1"][()]
        if is_moment:
            per_second = {"s": 1.0, "ms": 1e3, "us": 1e6}.get(kind.rpartition("[")[2].strip("]"), 1e9)
            return Column((values - values[:1].sum()) / per_second, "s")
        return Column(np.asarray(values, np.float64))

    names = {}
    for block in [key.removesuffix("_items") for key in group if key.endswith("_items")]:
        if group[f"{block}_values"].dtype.kind in "fiub":
            for number, name in enumerate(group[f"{block}_items"][()]):
                names[_decoded(name)] = (block, number)
    rows = len(group["axis1"])
    if group["axis1"].dtype.kind in "fiub":
        index_name = _decoded(group["axis1"].attrs.get("name", b""))
        unnamed = TIME if is_moment and TIME not in names else "index"
        yield f"{at}{unnamed if index_name in ('', 'N.', 'None') else index_name}", rows, index
    for name, (block, number) in names.items():
        yield f"{at}{name}", rows, read(block, number)


def _refuse_pytables(file: Any, path: Path) -> None:
    """Raises:
    BadInputError: a DataFrame that pandas wrote as a table, whose names are pickled.
    """
    for name in file:
        item = file[name]
        if hasattr(item, "keys") and "table" in item and "pandas_type" in item.attrs:
            raise BadInputError(
                f"'{name}' is a DataFrame of pandas with format='table', which is not read",
                where=str(path),
                fix='write it with to_hdf(…, format="fixed"), or to_parquet',
            )


def _short_names(table: Mapping[str, Column]) -> dict[str, Column]:
    """Names without the groups that all have in common."""
    paths = [name.split("/") for name in table]
    shared = 0
    while paths and all(len(path) > shared + 1 and path[shared] == paths[0][shared] for path in paths):
        shared += 1
    return {"/".join(path[shared:]): column for path, column in zip(paths, table.values(), strict=True)}


def _decoded(name: Any) -> str:
    return name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)
