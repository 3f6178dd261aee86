"""Parquet: one column a channel, its unit in the schema."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from hil.core.channels import CHANNELS, TIME, unit_of
from hil.core.errors import BadInputError
from hil.core.errors.wording import repeated
from hil.core.files import refuse_unless_regular, replacing
from hil.core.recording._column_map import AS_NAMED, ColumnMap
from hil.core.recording._evidence import EVIDENCE, evidence_of, has_evidence, take_evidence
from hil.core.recording._foreign_table import Column, recording_of
from hil.core.recording._table import Array, Recording, refuse_too_large

_INDEX = "__index_level_0__"  # pandas' name for an index without one


def read_parquet(path: Path, columns: ColumnMap = AS_NAMED) -> Recording:
    """Read a Parquet table, one column a channel.

    Raises:
        BadInputError: no Parquet file or a broken one, or a known channel that is no column of numbers.
    """
    refuse_unless_regular(path)
    table: dict[str, Column] = {}
    notes: list[str] = []
    try:
        with pq.ParquetFile(path, page_checksum_verification=True) as file:
            fields = file.schema_arrow
            _refuse_twice(fields.names, path)
            refuse_too_large(file.metadata.num_rows, len(fields), str(path))
            evidence = (fields.metadata or {}).get(EVIDENCE.encode())
            for field in fields:
                if _is_number(field.type):
                    table[field.name] = Column(_column(file, field.name), _unit(field))
                elif pa.types.is_timestamp(field.type) or pa.types.is_duration(field.type):
                    is_index = field.name == _INDEX and TIME not in fields.names
                    table[TIME if is_index else field.name] = Column(_since_first(file, field), "s")
                elif field.name in CHANNELS:
                    raise BadInputError(
                        f"holds {field.type}, not numbers",
                        where=f"{path}: column '{field.name}'",
                        fix="write it as 64-bit floats in the unit of its name",
                    )
                else:
                    notes.append(f"column '{field.name}' is not numeric ({field.type}) and was left out")
    except BadInputError:
        raise
    except Exception as error:  # of many kinds, for whatever is broken
        raise BadInputError("not a Parquet file, or a broken one", where=str(path)) from error
    recording = recording_of(table, path, columns, "column", notes, own=evidence is not None)
    if evidence is not None:
        take_evidence(recording, evidence, f"its metadata '{EVIDENCE}'")
    return recording


def write_parquet(recording: Recording, path: Path) -> None:
    """Write Parquet with a checksum for each page; each column carries its unit in its field's metadata.

    A row group is a block, so that the samples are not held all at once.
    What the recording has beside its samples stands in the file's metadata.
    """
    fields = [pa.field(name, pa.float64(), metadata={"unit": unit_of(name)}) for name in recording.channels]
    metadata = {EVIDENCE: evidence_of(recording)} if has_evidence(recording) else None
    schema = pa.schema(fields, metadata)
    with (
        replacing(path) as temporary,
        pq.ParquetWriter(temporary, schema, compression="zstd", write_page_checksum=True) as writer,
    ):
        for _, rows in recording.blocks():
            writer.write_table(pa.table(list(rows.values()), schema=schema))


def _refuse_twice(names: list[str], path: Path) -> None:
    twice = repeated(names)
    if twice:
        raise BadInputError(f"column '{twice[0]}' stands twice", where=str(path))


def _unit(field: Any) -> str:
    """What the file says of a column's unit; '' if nothing."""
    return str((field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace"))


def _is_number(kind: Any) -> bool:
    types = pa.types
    plain = kind.value_type if types.is_dictionary(kind) else kind
    return bool(
        types.is_integer(plain)
        or types.is_floating(plain)
        or types.is_decimal(plain)
        or types.is_boolean(plain)
        or types.is_null(plain)
    )


def _since_first(file: Any, field: Any) -> Array:
    """A column of moments or durations, as pandas writes an index of time, in s from the first."""
    whole = file.read(columns=[field.name]).column(0).cast(pa.int64()).to_numpy().astype(np.float64)
    per_second = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[field.type.unit]
    return np.asarray((whole - whole[:1].sum()) / per_second)


def _column(file: Any, name: str) -> Array:
    """One column as doubles; missing cells are NaN. One at a time, so that the table is not held twice."""
    values = np.empty(file.metadata.num_rows)
    filled = 0
    for batch in file.iter_batches(batch_size=1 << 16, columns=[name], use_threads=False):
        column = batch.column(0)
        if pa.types.is_dictionary(column.type):
            column = column.dictionary_decode()
        block = column.cast(pa.float64(), safe=False).to_numpy(zero_copy_only=False)
        values[filled : filled + len(block)] = block
        filled += len(block)
    if filled != len(values):
        raise ValueError("fewer rows than the file says")
    return values
