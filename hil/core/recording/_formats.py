"""Which function reads or writes which ending; each is imported when its ending is met.

Arrow and asammdf take longer to import than most commands take to work.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hil.core.recording._table import Recording

READ = (".mcap", ".csv", ".parquet", ".mf4", ".mat")
WRITTEN = (".csv", ".parquet", ".mf4", ".mat")
#: Logs of raw frames: BLF, ASC, candump. MDF4 may hold channels or frames.
FRAME_LOGS = (".blf", ".asc", ".log")


def reader_of(ending: str) -> Callable[[Path], Recording] | None:
    """What reads files of an ending of `READ`; None for any other."""
    match ending:
        case ".mcap":
            from hil.core.recording._mcap_reader import read_mcap

            return read_mcap
        case ".csv":
            from hil.core.recording._csv_reader import read_csv

            return read_csv
        case ".parquet":
            from hil.core.recording._parquet import read_parquet

            return read_parquet
        case ".mf4":
            from hil.core.recording._mdf import read_mdf

            return read_mdf
        case ".mat":
            from hil.core.recording._mat import read_mat

            return read_mat
    return None


def writer_of(ending: str) -> Callable[[Recording, Path], None] | None:
    """What writes files of an ending of `WRITTEN`; None for any other."""
    match ending:
        case ".csv":
            from hil.core.recording._csv_writer import write_csv

            return write_csv
        case ".parquet":
            from hil.core.recording._parquet import write_parquet

            return write_parquet
        case ".mf4":
            from hil.core.recording._mdf import write_mdf

            return write_mdf
        case ".mat":
            from hil.core.recording._mat import write_mat

            return write_mat
    return None
