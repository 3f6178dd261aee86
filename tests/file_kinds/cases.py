"""Small files as other tools write them: one case for each thing that is reported or refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from asammdf import MDF, Signal
from scipy.io import savemat

from hil.core.recording import Recording, RecordingWriter, write_recording

COUNT = 100
SECONDS = np.arange(COUNT) * 1e-3
TORQUE = 10 * np.sin(SECONDS * 60)
RPM = 900 + 50 * np.cos(SECONDS * 60)
MAP = ("motor_torque_ref_nm=T_req", "motor_speed_rad_s=n_EM")
TABLE = {"time_s": SECONDS, "T_req": TORQUE, "n_EM [rpm]": RPM}
OWN = {"time_s": SECONDS, "motor_torque_ref_nm": TORQUE, "motor_speed_rad_s": RPM / 10}


@dataclass(frozen=True)
class Case:
    """A file: name, what it is, what makes it, options of `--columns`, and whether it is a log of frames."""

    name: str
    what: str
    make: Callable[[Path], object]
    columns: tuple[str, ...] = ()
    is_log: bool = False


def text(content: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(content, "utf-8")


def begins(content: bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(content)


def rows(separator: str, *columns: list[str]) -> str:
    return "".join(separator.join(cells) + "\n" for cells in zip(*columns, strict=True))


def cells(values: np.ndarray, comma: bool = False, digits: int = 6) -> list[str]:
    texts = [f"{value:.{digits}f}" for value in values]
    return [one.replace(".", ",") for one in texts] if comma else texts


def plain(
    head: str, time: list[str] | None = None, separator: str = ",", speed: list[str] | None = None
) -> str:
    return head + rows(separator, time or cells(SECONDS), cells(TORQUE), speed or cells(RPM))


def parquet(path: Path) -> None:
    pq.write_table(pa.table(TABLE), path)


def mdf(path: Path) -> None:
    with MDF(version="4.10") as file:
        file.append([Signal(TORQUE, SECONDS, name="T_req", unit="Nm")])
        file.append([Signal(RPM[::2], SECONDS[::2], name="n_EM", unit="rpm")])
        file.save(path, overwrite=True)


def hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        for name, values in TABLE.items():
            file[f"run/{name}"] = values


def tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        reported = {"wf_increment": 1e-3}
        writer.write_segment(
            [
                ChannelObject("run", "T_req", TORQUE, properties={**reported, "unit_string": "Nm"}),
                ChannelObject("run", "n_EM", RPM, properties={**reported, "unit_string": "rpm"}),
            ]
        )


def mcap(path: Path) -> None:
    writer = RecordingWriter(path, list(OWN), [])
    writer.add_rows(np.column_stack(list(OWN.values())))
    writer.close()


def exported(path: Path) -> None:
    write_recording(Recording(dict(OWN), path), path)


_STAMPS = [f"23:59:59.{950 + k:03d}" if k < 50 else f"00:00:00.{k - 50:03d}" for k in range(COUNT)]
_SENTINEL = ["-9999" if k == 40 else cell for k, cell in enumerate(cells(RPM))]
_BLANKS = [cell if k % 5 == 0 else "" for k, cell in enumerate(cells(RPM))]
_ROUNDED = [f"{np.floor(k * 2.5e-3 / 1e-3) * 1e-3:.3f}" for k in range(COUNT)]
_REPEATED = [f"{(k * k) // 400 * 0.01:.2f}" for k in range(COUNT)]
_COUNTER = [f"{(65_500 + k) % 65_536}" for k in range(COUNT)]
_IND = ["-1.#IND" if k == 40 else cell for k, cell in enumerate(cells(RPM))]
_LVM = "LabVIEW Measurement\t\nDelta_X\t0.001\n***End_of_Header***\t\nX_Value\tT_req\tn_EM\tComment\n"
_INCA = (
    "ETASAsciiItemFile\trecord\tCrLf\tTab\nsampleCount\t100\n"
    'time\tT_req\tn_EM\nf8\tf8\tf8\n"s"\t"Nm"\t"rpm"\n'
)
_DESK = "fileVersion,2.0\npath,,Root/T_req,Root/n_EM\nname,xAxis,T_req,n_EM\nunit,s,Nm,rpm\n"
_LABEL = ["trace_values", *[""] * (COUNT - 1)]

TABLES = (
    Case("own.mcap", "this software's recording", mcap),
    Case("export.csv", "CSV with the channels' names", exported),
    Case("other.csv", "no channel's name, no map", text("zeit,M_soll,n\n0,1,2\n")),
    Case("units.csv", "a line of units", text(plain("time_s,T_req,n_EM\ns,kN m,1/min\n")), MAP),
    Case("strange_unit.csv", "a unit that is none", text(plain("time_s,T_req,n_EM\ns,Nm,Umdr.\n")), MAP),
    Case("no_unit.csv", "a column without a unit", text(plain("time_s,T_req,n_EM\n")), MAP),
    Case("ambiguous.csv", "1/s for a speed", text(plain("time_s,T_req,n_EM [1/s]\n")), MAP),
    Case(
        "decimal_comma.csv",
        "decimal commas with exponent",
        text(
            "time_s;T_req;n_EM [rpm]\n"
            + rows(
                ";", cells(SECONDS, True), [f"{t:.3e}".replace(".", ",") for t in TORQUE], cells(RPM, True)
            )
        ),
        MAP,
    ),
    Case(
        "desk.csv",
        "ControlDesk",
        text(_DESK + rows(",", _LABEL, cells(SECONDS), cells(TORQUE), cells(RPM))),
        MAP,
    ),
    Case("view.lvm", "LabVIEW", text(plain(_LVM, separator="\t")), (MAP[0], f"{MAP[1]}, unit=rpm")),
    Case("inca.ascii", "INCA", text(plain(_INCA, separator="\t")), MAP),
    Case(
        "puma.txt",
        "time of day, units, footer (PUMA)",
        text(plain("Bench: 7\nTIME;T_req;n_EM\nhh:mm:ss;Nm;1/min\n", _STAMPS, ";") + "\nMIN;-10;850\n"),
        MAP,
    ),
    Case("blanks.csv", "columns of two rates", text(plain("time_s,T_req,n_EM [rpm]\n", speed=_BLANKS)), MAP),
    Case("rounded.csv", "stamps rounded to 1 ms", text(plain("time_s,T_req,n_EM [rpm]\n", _ROUNDED)), MAP),
    Case(
        "repeated.csv",
        "stamps that repeat unevenly",
        text(plain("time_s,T_req,n_EM [rpm]\n", _REPEATED)),
        MAP,
    ),
    Case("counter.csv", "a counter of 16 bits", text(plain("time_ms,T_req,n_EM [rpm]\n", _COUNTER)), MAP),
    Case(
        "sentinel.csv", "-9999 for no value", text(plain("time_s,T_req,n_EM [rpm]\n", speed=_SENTINEL)), MAP
    ),
    Case("ind.csv", "1.#IND", text(plain("time_s,T_req,n_EM [rpm]\n", speed=_IND)), MAP),
    Case("two.csv", "samples below text", text(plain("time_s,T_req,n_EM\n") + plain("again\n")), MAP),
    Case(
        "map.csv", "a map that does not fit", text(plain("time_s,T_req,n_EM\n")), ("motor_speed_rad_s=n_EN",)
    ),
    Case("tabs.tsv", "tabs", text(plain("time_s\tT_req\tn_EM [rpm]\n", separator="\t")), MAP),
    Case("table.parquet", "Parquet", parquet, MAP),
    Case("groups.mf4", "MDF4 with two groups", mdf, MAP),
    Case(
        "vectors.mat",
        "MAT of level 5",
        lambda path: savemat(path, {"time_s": SECONDS, "T_req": TORQUE, "n_EM": RPM}),
        (MAP[0], f"{MAP[1]}, unit=rpm"),
    ),
    Case("vectors.h5", "HDF5", hdf5, MAP),
    Case("vectors.hdf5", "HDF5", hdf5, MAP),
    Case("vectors.hdf", "HDF5", hdf5, MAP),
    Case("waves.tdms", "TDMS", tdms, MAP),
    Case("sheet.csv", "a spreadsheet under another name", begins(b"PK\x03\x04")),
)

_HEAD = "date Mon Mar 7 01:21:51.000 pm 2005\nbase hex  timestamps absolute\ninternal events logged\n"


def _block(second: str, *stamps: float) -> str:
    lines = "".join(f"   {stamp:.6f} 1  100  Rx   d 1 01\n" for stamp in stamps)
    return f"Begin Triggerblock Mon Mar 7 01:{second}.000 pm 2005\n{lines}End TriggerBlock\n"


_BUSMASTER = (
    "***BUSMASTER Ver 2.4.0***\n***START DATE AND TIME 8:8:2014 11:49:7:965***\n"
    "***HEX***\n***SYSTEM MODE***\n"
    "11:49:12:9420 Rx 1 0x023 s 1 40\n11:49:12:9440 Rx 1 0x460 s 1 03\n"
)
_CANDUMP = "(1700000000.0) can0 123#01\n(1700000000.1) can0 123#02\n"
LOGS = (
    Case("plain.log", "candump", text(_CANDUMP), is_log=True),
    Case("odd.log", "a line that is no frame", text(_CANDUMP + "what is this\n"), is_log=True),
    Case("cut.log", "a last line that is cut off", text(_CANDUMP + "(1700000000.2) can0 12"), is_log=True),
    Case("back.log", "stamps that go back", text(_CANDUMP + "(1699999999.0) can0 123#03\n"), is_log=True),
    Case("set.log", "a clock that was set", text("(12.0) can0 123#01\n" + _CANDUMP), is_log=True),
    Case("busmaster.log", "BusMaster", text(_BUSMASTER), is_log=True),
    Case("one.asc", "ASC", text(_HEAD + _block("21:51", 0.1, 0.2)), is_log=True),
    Case(
        "from_log.asc",
        "two trigger blocks, stamps from the log's begin",
        text(_HEAD + _block("21:51", 0.1) + _block("22:01", 10.1)),
        is_log=True,
    ),
    Case(
        "from_block.asc",
        "two trigger blocks, stamps from each block's begin",
        text(_HEAD + _block("21:51", 0.1) + _block("22:01", 0.1)),
        is_log=True,
    ),
    Case(
        "either.asc",
        "two trigger blocks that fit both ways",
        text(_HEAD + _block("21:51", 0.1) + _block("22:11", 40.0)),
        is_log=True,
    ),
    Case(
        "of_day.asc",
        "ASC of BusMaster",
        text(
            "date Mon Dec 6 11:21:13 am 2021\nbase hex  no internal events logged\n"
            "40874.8082 1 122 Rx d 1 E3\n"
        ),
        is_log=True,
    ),
    Case("channels.mf4", "MDF4 with channels", mdf, is_log=True),
)
