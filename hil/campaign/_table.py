"""The table of a campaign as others read it: while it grows, and as one file."""

from __future__ import annotations

import contextlib
from collections import Counter
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from hil.analysis.campaigns import Share
from hil.campaign._parts import FOLDER
from hil.core.files import replacing


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
