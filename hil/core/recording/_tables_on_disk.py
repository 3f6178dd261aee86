"""CSV, Parquet and MDF4: the forms in which other tools keep a table of channels."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pandas as pd

from hil.core.channels import CHANNELS, TIME
from hil.core.errors import BadInputError
from hil.core.files import read_text, replacing
from hil.core.recording._table import Recording


def read_csv(path: Path) -> Recording:
    """Read a CSV with one header line; messages name file, line and column."""
    lines = read_text(path).lstrip("\ufeff").splitlines()
    header = [cell.strip() for cell in lines[0].split(",")] if lines else []
    if TIME not in header:
        raise BadInputError(
            f"the header line has no '{TIME}'",
            where=f"{path}: line 1",
            fix="the first line names the channels",
        )
    duplicate = {name for name in header if header.count(name) > 1}
    if duplicate:
        raise BadInputError(f"column '{sorted(duplicate)[0]}' stands twice", where=f"{path}: line 1")
    try:
        frame = pd.read_csv(path, encoding="utf-8-sig", skipinitialspace=True, index_col=False)
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise BadInputError(f"not a CSV table: {str(error).strip()}", where=str(path)) from error
    frame.columns = [str(name).strip() for name in frame.columns]
    return _from_frame(frame, path, first_line=2)


def read_parquet(path: Path) -> Recording:
    """Read a Parquet table, one column a channel."""
    read_bytes_or_explain(path)
    try:
        frame = pd.read_parquet(path)
    except Exception as error:
        raise BadInputError("not a Parquet file, or a broken one", where=str(path)) from error
    return _from_frame(frame, path, first_line=1)


def read_mdf(path: Path) -> Recording:
    """Read MDF4 with asammdf; channels of different rates are put on the input's time stamps."""
    read_bytes_or_explain(path)
    from asammdf import MDF  # slow to import, and seldom needed

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with MDF(path) as mdf:
                frame = mdf.to_dataframe(time_from_zero=False)
    except Exception as error:
        raise BadInputError("not an MDF file, or a broken one", where=str(path)) from error
    if TIME not in frame.columns:
        frame.insert(0, TIME, frame.index.to_numpy())
    return _from_frame(frame, path, first_line=1)


def write_csv(recording: Recording, path: Path) -> None:
    """Write every channel with 9 significant digits, time with 1 µs."""
    frame = pd.DataFrame(recording.channels)
    with replacing(path) as temporary:
        frame.to_csv(temporary, index=False, float_format="%.9g", encoding="utf-8")


def write_parquet(recording: Recording, path: Path) -> None:
    """Write Parquet; each column carries its unit in the schema's field metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [
        pa.field(name, pa.float64(), metadata={"unit": CHANNELS[name].unit if name in CHANNELS else ""})
        for name in recording.channels
    ]
    table = pa.table(list(recording.channels.values()), schema=pa.schema(fields))
    with replacing(path) as temporary:
        pq.write_table(table, temporary, compression="zstd")


def write_mdf(recording: Recording, path: Path) -> None:
    """Write MDF 4.10 with units and comments."""
    from asammdf import MDF, Signal

    signals = [
        Signal(
            samples=values,
            timestamps=recording.time_s,
            name=name,
            unit=CHANNELS[name].unit if name in CHANNELS else "",
            comment=CHANNELS[name].meaning if name in CHANNELS else "",
        )
        for name, values in recording.channels.items()
        if name != TIME
    ]
    with replacing(path) as temporary, MDF(version="4.10") as mdf:
        mdf.append(signals, comment="eaxle-hil recording", common_timebase=True)
        mdf.save(temporary, overwrite=True, compression=2)


def read_bytes_or_explain(path: Path) -> bytes:
    """First bytes of a file; BadInputError tells why it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(8)
    except OSError as error:
        raise BadInputError(error.strerror or str(error), where=str(path), fix="check the path") from error


def _from_frame(frame: pd.DataFrame, path: Path, first_line: int) -> Recording:
    channels = {}
    notes = []
    for name in frame.columns:
        column = frame[name]
        numbers = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
        wrong = np.flatnonzero(np.isnan(numbers) & column.notna().to_numpy())
        if wrong.size and name in CHANNELS:
            row = int(wrong[0])
            raise BadInputError(
                f"{column.iloc[row]!r} is not a number",
                where=f"{path}: line {row + first_line}, column '{name}'",
            )
        if wrong.size:
            notes.append(f"column '{name}' is not numeric and was left out")
            continue
        channels[str(name)] = numbers
    return Recording(channels, path, notes=notes)
