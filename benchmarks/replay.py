"""Decoding a log of a million frames, file reading included, by ours, by asammdf and by cantools.

`python -m benchmarks.replay`: one MF4 file (ASAM bus logging), one DBC, the same signals; the values are
compared one by one. python-can reads the frames for cantools, as who decodes frame by frame does. Of ours and
of asammdf's bus-logging extraction it is the median of three turns, taken alternately; cantools takes one.
"""

from __future__ import annotations

import importlib
import statistics
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping, Set
from pathlib import Path
from typing import Any

import cantools
import numpy as np
from can.io import mf4

from benches import __file__ as benches
from benchmarks.answers import OtherAnswerError, largest_difference
from hil.core.can.dbc_messages import decoded, read_messages_of
from hil.core.can.frames import FrameBlock, frames
from hil.core.can_logs import read_can_log
from hil.core.recording import RecordingWriter, read_as_written, write_frames

FRAMES, TURNS = 1_000_000, 3
SAME = 1e-12  # a share of a value: scaled in another order
DBC = Path(benches).parent / "rmcu.dbc"
Values = Mapping[str, np.ndarray[Any, Any]]


def main() -> None:
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        log = made(Path(folder))
        ours, theirs = [], []
        for _ in range(TURNS):
            ours.append(timed(lambda: by_blocks(log)))
            theirs.append(timed(lambda: by_asammdf(log)))
        frame_by_frame = timed(lambda: by_cantools(log))
        size = log.stat().st_size
    first = ours[0][1]
    named = signals_with_names()
    same = [
        f"{name}: {len(values)} signals, {sum(map(len, values.values())):,} values, "
        f"{apart(first, values, named)}"
        for name, values in (("asammdf", theirs[0][1]), ("cantools", frame_by_frame[1]))
    ]
    own_s, asammdf_s = (statistics.median(s for s, _ in turns) for turns in (ours, theirs))
    print(f"{FRAMES:,} frames, {size / 1e6:.0f} MB, {len(first)} signals of {DBC.name}; reading included")
    print(f"{'':44}{'s':>8}{'frames/s':>12}{'ours is':>10}")
    for name, seconds in (
        ("hil replay's decoder", own_s),
        ("asammdf extract_bus_logging", asammdf_s),
        ("python-can and cantools, frame by frame", frame_by_frame[0]),
    ):
        print(f"{name:44}{seconds:8.2f}{FRAMES / seconds:12,.0f}{seconds / own_s:9.1f} x")
    print("\n".join(same))


def made(folder: Path) -> Path:
    """An MF4 log: every message of the DBC in turn, with random payloads."""
    database: Any = cantools.database.load_file(DBC)
    messages = [message for message in database.messages if message.length == 8]
    random = np.random.default_rng(1)
    block = frames(
        0, random.integers(0, 1 << 63, FRAMES, dtype=np.uint64), 8, 1e-4 * np.arange(float(FRAMES))
    )
    block["id"] = np.resize([message.frame_id for message in messages], FRAMES)
    return written(block, folder)


def written(block: FrameBlock, folder: Path) -> Path:
    recording = folder / "log.mcap"
    writer = RecordingWriter(recording, ["time_s", "motor_torque_ref_nm"], ["rmcu"])
    writer.add_frames("rmcu", block)
    writer.add_rows(np.array([[0.0, 0.0], [1.0, 0.0]]))
    writer.close()
    log = folder / "log.mf4"
    write_frames(read_as_written(recording), log)
    return log


def timed(work: Callable[[], Values]) -> tuple[float, Values]:
    began = time.perf_counter()
    values = work()
    return time.perf_counter() - began, values


def by_blocks(log: Path) -> Values:
    layouts, _ = read_messages_of(DBC)
    found: dict[str, np.ndarray[Any, Any]] = {}
    for block in read_can_log(log).channels.values():
        for samples in decoded(block, layouts):
            name = samples.layout.name
            found |= {f"{name}.{signal}": values for signal, values in samples.values.items()}
    return found


def by_asammdf(log: Path) -> Values:
    from asammdf import MDF

    found = {}
    with MDF(log) as mdf, mdf.extract_bus_logging({"CAN": [(DBC, 0)]}) as extracted:
        for number, group in enumerate(extracted.groups):
            message = group.channel_group.comment.split()[3]  # "CAN1 - message NAME …"
            for index, channel in enumerate(group.channels[1:], 1):
                found[f"{message}.{channel.name}"] = extracted.get(group=number, index=index).samples
    return found


def by_cantools(log: Path) -> Values:
    importlib.reload(mf4)
    database: Any = cantools.database.load_file(DBC)
    found: dict[str, list[float]] = {}
    with log.open("rb") as file, mf4.MF4Reader(file) as reader:
        for message in reader:
            name = database.get_message_by_frame_id(message.arbitration_id).name
            values = database.decode_message(message.arbitration_id, message.data, decode_choices=False)
            for signal, value in values.items():
                found.setdefault(f"{name}.{signal}", []).append(value)
    return {name: np.array(values, float) for name, values in found.items()}


def apart(ours: Values, theirs: Values, named: Set[str]) -> str:
    """By how much values differ, as a share of the larger, and how many of `named` signals are left out.

    Raises:
        OtherAnswerError: they are not the same values of the same signals.
    """
    if ours.keys() != theirs.keys():
        raise OtherAnswerError(f"not the same signals: {sorted(ours.keys() ^ theirs.keys())}")
    worst, left_out = 0.0, 0
    for name, values in ours.items():
        other = np.asarray(theirs[name], float)
        known = np.isfinite(values)  # random payloads hold floats that are no numbers
        there = np.isfinite(other) if other.shape == values.shape else known
        if name in named:
            left_out += int(np.count_nonzero(known & ~there))
            known = known & there
        elif (there != known).any():
            raise OtherAnswerError(
                f"{name}: {np.count_nonzero(there)} numbers, here {np.count_nonzero(known)}"
            )
        worst = max(worst, largest_difference(name, values[known], other[known], SAME, relative=True))
    words = f"the largest difference is {worst:.1e} of a value"
    return f"{words}; {left_out:,} it leaves out, of signals whose values have names" if left_out else words


def signals_with_names() -> Set[str]:
    """Signals whose values have names in the DBC: asammdf gives no number for what has none."""
    database: Any = cantools.database.load_file(DBC)
    return {f"{m.name}.{s.name}" for m in database.messages for s in m.signals if s.choices}


if __name__ == "__main__":
    main()
