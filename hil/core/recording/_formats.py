"""Which function reads or writes which ending; each is imported when its ending is met.

Arrow and asammdf take longer to import than most commands take to work.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from hil.core.errors import BadInputError
from hil.core.recording._column_map import ColumnMap
from hil.core.recording._table import Recording

_PACKAGE = "hil.core.recording"
#: Module and function that read an ending.
_READERS = {
    ".mcap": ("_mcap_reader", "read_mapped_mcap"),
    **dict.fromkeys((".csv", ".txt", ".tsv", ".lvm", ".ascii"), ("_csv_reader", "read_csv")),
    ".parquet": ("_parquet", "read_parquet"),
    ".mf4": ("mdf", "read_mdf"),
    ".mat": ("_mat", "read_mat"),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), ("_hdf5", "read_hdf5")),
    ".tdms": ("_tdms", "read_tdms"),
}
_WRITERS = {
    ".csv": ("_csv_block", "write_csv"),
    ".parquet": ("_parquet", "write_parquet"),
    ".mf4": ("mdf", "write_mdf"),
    ".mat": ("_mat", "write_mat"),
}
READ, WRITTEN = tuple(_READERS), tuple(_WRITERS)
#: Logs of raw frames: BLF, ASC, candump. MDF4 may hold channels or frames.
FRAME_LOGS = (".blf", ".asc", ".log")

_FRAMES = "decode it with hil replay; it gives a recording.mcap"
_AS_TABLE = "save it as CSV or Parquet"
_OF_ASAMMDF = "asammdf converts it: asammdf.MDF(FILE).convert('4.10').save('FILE.mf4')"
#: What is not read, by its ending: what it is, and what reads it.
NOT_READ = {
    **dict.fromkeys((*FRAME_LOGS, ".trc"), ("a log of raw frames", _FRAMES)),
    **dict.fromkeys((".xlsx", ".xls", ".ods"), ("a spreadsheet", _AS_TABLE)),
    **dict.fromkeys((".mdf", ".dat"), ("MDF of version 3", _OF_ASAMMDF)),
    **dict.fromkeys(
        (".feather", ".arrow"), ("an Arrow file", "pyarrow.feather.read_table, then write Parquet")
    ),
    **dict.fromkeys((".npz", ".npy"), ("NumPy's", "numpy.load, then write Parquet by pandas")),
    **dict.fromkeys((".pkl", ".pickle"), ("a pickle, which can run code", "pandas.DataFrame.to_parquet")),
    **dict.fromkeys((".bag", ".db3"), ("a ROS bag", "rosbags reads it, then write Parquet by pandas")),
    **dict.fromkeys((".tdm", ".tdx"), ("DIAdem's older TDM", "save it as TDMS in DIAdem")),
    **dict.fromkeys((".uff", ".unv"), ("a universal file", "pyuff reads it, then write Parquet by pandas")),
    **dict.fromkeys((".zip", ".gz", ".zst", ".7z"), ("packed", "unpack it")),
}
_BEGINS = (
    (b"PK\x03\x04", "a spreadsheet or a packed file", "save it as CSV or Parquet, or unpack it"),
    (b"\x1f\x8b", "packed", "unpack it"),
    (b"MDF     ", "MDF", "name it .mf4; version 3: " + _OF_ASAMMDF),
    (b"\x89HDF\r\n\x1a\n", "HDF5", "name it .h5"),
    (b"TDSm", "TDMS", "name it .tdms"),
    (b"LOGG", "a BLF log of raw frames", _FRAMES),
    (b"PAR1", "Parquet", "name it .parquet"),
    (b"\x89MCAP0\r\n", "MCAP", "name it .mcap"),
)
_OWN_BEGINS = {".mf4": b"MDF", ".h5": b"\x89HDF", ".hdf5": b"\x89HDF", ".hdf": b"\x89HDF", ".mat": b"\x89HDF"}


def reader_of(path: Path) -> Callable[[Path, ColumnMap], Recording]:
    """What reads a file.

    Raises:
        BadInputError: nothing here does; it says what the file is and what would read it.
    """
    ending = path.suffix.lower()
    if ending not in _READERS:
        what, fix = NOT_READ.get(ending, ("", "rename or convert the file"))
        known = f"recordings end in {', '.join(READ)}"
        raise BadInputError(f"is {what}: {known}" if what else known, where=str(path), fix=fix)
    _refuse_misnamed(path, ending)
    module, function = _READERS[ending]
    found: Callable[[Path, ColumnMap], Recording] = getattr(import_module(f"{_PACKAGE}.{module}"), function)
    return found


def _refuse_misnamed(path: Path, ending: str) -> None:
    """Refuse what its first bytes say is something else; what cannot be opened its reader refuses."""
    begin = b""
    if path.is_file():
        with contextlib.suppress(OSError), path.open("rb") as file:
            begin = file.read(8)
    own = {".tdms": b"TDSm", ".parquet": b"PAR1", ".mcap": b"\x89MCAP", **_OWN_BEGINS}.get(ending, b"\n\n")
    for magic, what, fix in _BEGINS:
        if begin.startswith(magic) and not magic.startswith(own):
            raise BadInputError(f"is no {ending} file but {what}", where=str(path), fix=fix)


def writer_of(ending: str) -> Callable[[Recording, Path], None] | None:
    """What writes files of an ending of `WRITTEN`; None for any other."""
    if ending not in _WRITERS:
        return None
    module, function = _WRITERS[ending]
    found: Callable[[Recording, Path], None] = getattr(import_module(f"{_PACKAGE}.{module}"), function)
    return found
