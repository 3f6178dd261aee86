"""The table of a campaign on disk: part files that appear whole, read while it grows, and joined at its end.

Each part has a fixed run of simulations.
"""

from __future__ import annotations

import contextlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from hil.analysis.campaigns import Share, column_units
from hil.campaign._execute import Batch, Row
from hil.campaign._setting import Setting
from hil.core.errors import BadInputError
from hil.core.files import read_text, replacing, write_atomically
from hil.core.files.toml_file import FORMAT

STARTED, FOLDER = "started.json", "simulations"
_NOT_THIS = "name another place with --out, or begin it anew with --overwrite"


class Parts:
    """The part files in `folder`.

    Args:
        folder: of the campaign's results.
        setting: the campaign.
        drawn: columns of what differs from car to car.
        batch: simulations in a part file; all but the last have as many.
    """

    def __init__(self, folder: Path, setting: Setting, drawn: Iterable[str], batch: int) -> None:
        self.folder = folder / FOLDER
        self.batch = batch
        self._count = len(setting.cases)
        self._schema = _schema(setting, tuple(drawn))

    def __iter__(self) -> Iterator[Batch]:
        for first in range(0, self._count, self.batch):
            yield self.holding(Batch(first, first))

    def holding(self, batch: Batch) -> Batch:
        """The batch of the part file that a batch or a part of one belongs to."""
        first = batch.first - batch.first % self.batch
        return Batch(first, min(first + self.batch, self._count) - 1)

    def path(self, batch: Batch) -> Path:
        """The file of a batch."""
        return self.folder / f"part-{batch.first:07d}-{batch.last:07d}.parquet"

    def missing(self) -> list[Batch]:
        """Batches that are not done; a file that cannot be read, or has other rows, is not done."""
        return [batch for batch in self if not self._done(batch)]

    def write(self, batch: Batch, rows: list[Row]) -> None:
        """Put a batch's rows on disk, whole.

        Raises:
            BenchError: the disk is full.
        """
        table = pa.Table.from_pylist(rows, schema=self._schema)
        with replacing(self.path(batch)) as file:
            pq.write_table(table, file)

    def table(self) -> pd.DataFrame:
        """Every row that is there, by number."""
        found = [pq.read_table(self.path(batch)) for batch in self if self._done(batch)]
        table: pd.DataFrame = pa.concat_tables([self._schema.empty_table(), *found]).to_pandas()
        return table

    def _done(self, batch: Batch) -> bool:
        with contextlib.suppress(OSError, pa.ArrowInvalid):
            there = pq.read_schema(self.path(batch))
            rows = pq.read_metadata(self.path(batch)).num_rows
            same = there.metadata and there.metadata.get(b"campaign") == self._schema.metadata[b"campaign"]
            return bool(same) and rows == len(batch)
        return False


def write_begun(folder: Path, setting: Setting, batch: int) -> None:
    """Write down what is started here, before anything is done."""
    content = {
        "format": FORMAT,
        "campaign": setting.file.name,
        "simulations": len(setting.cases),
        "batch": batch,
        "identity": setting.identity,
    }
    write_atomically(folder / STARTED, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def begun_batch(folder: Path, setting: Setting) -> int:
    """Simulations in a part file of what was started here; 0 if nothing was.

    Raises:
        BadInputError: another campaign was started here, or one of its files has changed since.
    """
    path = folder / STARTED
    if not path.exists():
        return 0
    try:
        content = json.loads(read_text(path))
        batch, identity = int(content["batch"]), dict(content["identity"])
        if batch < 1:
            raise ValueError("no batch")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BadInputError(f"cannot be read: {error}", where=str(path), fix=_NOT_THIS) from None
    changed = _changed(identity, setting.identity)
    if changed:
        raise BadInputError(
            f"was started with other files: {', '.join(changed)}",
            where=str(folder),
            fix=f"restore these files; or {_NOT_THIS}",
        )
    return batch


def _changed(before: Mapping[str, Any], now: Mapping[str, str]) -> list[str]:
    names = [*now, *(name for name in before if name not in now)]
    return [name for name in names if before.get(name) != now.get(name)]


def _schema(setting: Setting, drawn: tuple[str, ...]) -> pa.Schema:
    """One row for each simulation; units stand in the fields' metadata."""
    units = column_units(setting.cases.axes, drawn)
    fields = [
        pa.field("simulation", pa.int64()),
        pa.field("controller", pa.string()),
        pa.field("draw", pa.int32()),
    ]
    fields += [_number(name, unit) for name, unit in units.items()]
    for one in setting.criteria:
        fields += [_number(f"value.{one.id}", one.metric.unit), _number(f"margin.{one.id}", "1")]
        fields.append(pa.field(f"verdict.{one.id}", pa.string()))
    fields += [_number("margin", "1"), pa.field("verdict", pa.string()), pa.field("error", pa.string())]
    fields.append(_number("processor_s", "s"))
    return pa.schema(fields, metadata={"campaign": setting.digest})


def _number(name: str, unit: str) -> pa.Field:
    return pa.field(name, pa.float64(), metadata={"unit": unit})


class Tally:
    """How many simulations of each controller have passed, counted as part files appear.

    Args:
        folder: of the campaign's results.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FOLDER
        self._seen: set[str] = set()
        self._of: Counter[str] = Counter()
        self._passed: Counter[str] = Counter()

    def look(self) -> dict[str, Share]:
        """By controller, in the order of their names."""
        for path in sorted(self._folder.glob("part-*.parquet")):
            if path.name not in self._seen:
                with contextlib.suppress(OSError, pa.ArrowInvalid):  # damaged: it is done again
                    self._count(path)
        return {name: Share(self._passed[name], self._of[name]) for name in sorted(self._of)}

    def _count(self, path: Path) -> None:
        columns = pq.read_table(path, columns=["controller", "verdict"]).to_pydict()
        self._of.update(columns["controller"])
        self._passed.update(
            name for name, verdict in zip(*columns.values(), strict=True) if verdict == "pass"
        )
        self._seen.add(path.name)


def write_table(folder: Path, file: Path) -> int:
    """Write the rows of all part files into one, in the order of their numbers; how many there are.

    Without a part file nothing is written.

    Raises:
        BenchError: the disk is full.
    """
    parts = sorted((folder / FOLDER).glob("part-*.parquet"))
    if not parts:
        return 0
    rows = 0
    with replacing(file) as temporary, pq.ParquetWriter(temporary, pq.read_schema(parts[0])) as writer:
        for part in parts:
            table = pq.read_table(part)
            writer.write_table(table)
            rows += table.num_rows
    return rows
