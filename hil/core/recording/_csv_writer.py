"""Writes CSV block by block: decimal numbers in every row, nine significant digits."""

from __future__ import annotations

import csv
import hashlib
import io
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as compute
import pyarrow.csv as arrow_csv

from hil.core.channels import TIME
from hil.core.files import replacing, write_atomically
from hil.core.recording._evidence import evidence_of, has_evidence, remove_sidecar, sidecar
from hil.core.recording._table import Array, Recording

_ROWS_AT_ONCE = 1 << 16
_DIGITS = 9
_POWERS = np.array([float(f"1e{power}") for power in range(23)])  # these are exact doubles
_LARGEST_EXACT_TIME_S = 9e6  # in whole nanoseconds still an exact double


def write_csv(recording: Recording, path: Path) -> None:
    """Write every channel with 9 significant digits, `time_s` in whole nanoseconds.

    A number always has a decimal point (1.0, not 1); a missing one is an empty cell. What the recording has
    beside its samples stands in a file next to it (`sidecar`).
    """
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(recording.channels)
    options = arrow_csv.WriteOptions(include_header=False, quoting_style="none")
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(header.getvalue().encode())
        for _, rows in recording.blocks(at_once=_ROWS_AT_ONCE):
            block = {name: _as_text(values, is_time=name == TIME) for name, values in rows.items()}
            arrow_csv.write_csv(pa.table(block), file, options)
        file.close()
        if has_evidence(recording):
            write_atomically(sidecar(path), evidence_of(recording, sha256_of(temporary)))
        else:
            remove_sidecar(path)


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _as_text(values: Array, *, is_time: bool) -> pa.Array:
    rounded = _whole_nanoseconds(values) if is_time else _nine_digits(values)
    shortest = compute.cast(pa.array(rounded, from_pandas=True), pa.string())  # NaN: an empty cell
    return compute.replace_substring_regex(shortest, r"^(-?\d+)(e.*)?$", r"\1.0\2")


def _whole_nanoseconds(time_s: Array) -> Array:
    exact = np.abs(time_s) < _LARGEST_EXACT_TIME_S
    return np.where(exact, np.rint(np.where(exact, time_s, 0.0) * 1e9) / 1e9, time_s)


def _nine_digits(values: Array) -> Array:
    """The doubles nearest to the values' decimals of nine significant digits."""
    rounded = np.array(values, np.float64)
    usual = (np.abs(rounded) > 1e-13) & (np.abs(rounded) < 1e29)
    some = rounded[usual]
    power = _DIGITS - 1 - np.floor(np.log10(np.abs(some))).astype(np.intp)
    scale = _POWERS[np.abs(power)]
    # the quotient and the product of two exact doubles are the doubles nearest to the decimal
    rounded[usual] = np.where(power >= 0, np.rint(some * scale) / scale, np.rint(some / scale) * scale)
    for index in np.flatnonzero(~usual & np.isfinite(rounded) & (rounded != 0)):
        rounded[index] = float(f"{rounded[index]:.{_DIGITS}g}")
    return rounded
