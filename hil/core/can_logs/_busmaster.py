"""BusMaster's own logs (`.log`): text with a head that says how stamps and numbers are written.

Source: LogObjectCAN.cpp and BaseLogObject.cpp of BUSMASTER (lines of the head, modes, columns).
"""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import can

_BEGIN = re.compile(rb"-?\*\*\*BUSMASTER", re.IGNORECASE)
_STARTED = re.compile(r"\*+START DATE AND TIME\D*(\d+):(\d+):(\d+)\s+(\d+):(\d+):(\d+):(\d+)")
_FRAME = re.compile(
    r"(\d+):(\d+):(\d+):(\d{4})\s+(Rx|Tx)\s+(\d+)\s+(0x[0-9A-Fa-f]+|\d+)\s+(s|x|sr|xr)\s+(\d+)((?:\s+[0-9A-Fa-f]+)*)\s*"
)
_DAY_S = 86_400.0
_MOST_ODD = 1000


def is_busmaster(path: Path) -> bool:
    """Whether a file begins as BusMaster's logs do."""
    with path.open("rb") as file:
        return _BEGIN.match(file.read(64).lstrip(b"\xef\xbb\xbf\r\n ")) is not None


def messages_of(lines: Iterable[str], remarks: list[str]) -> Iterator[can.Message]:
    """Frames with stamps since 1970, from the date of each session's head.

    In system mode a stamp is a time of day, and one that goes back by half a day has passed midnight; in
    absolute mode it counts from the session's begin, in relative mode from the frame before.

    Raises:
        ValueError: no frame at all, or a session without a date.
    """
    mode, base = "SYSTEM", 16
    zero_s: float | None = None
    newest_s, odd, first_odd, frames = 0.0, 0, 0, 0
    for number, line in enumerate(lines, 1):
        text = line.strip()
        started = _STARTED.match(text)
        if started is not None:
            zero_s, newest_s = _moment_s(started), 0.0
        elif text.startswith("***"):
            base = {"***DEC***": 10, "***HEX***": 16}.get(text, base)
            mode = text.strip("* ").partition(" ")[0] if text.endswith("MODE***") else mode
        elif text and (found := _FRAME.fullmatch(text)):
            if zero_s is None:
                raise ValueError("frames before START DATE AND TIME")
            since_s = _since_s(found)
            if mode == "RELATIVE":
                since_s += newest_s
            elif mode == "SYSTEM":
                since_s -= _of_day_s(zero_s)
                while since_s < newest_s - 0.5 * _DAY_S:
                    since_s += _DAY_S
            newest_s = since_s
            frames += 1
            yield _message(found, zero_s + since_s, base)
        elif text:
            odd, first_odd = odd + 1, first_odd or number
            if not frames and odd >= _MOST_ODD:
                break
    if not frames:
        raise ValueError(f"line {first_odd} is no frame" if odd else "no frame")
    remarks.append(f"is BusMaster's: stamps are of {mode.lower()} mode, on its date in local time")
    if odd:
        lines_in_words = "1 line is" if odd == 1 else f"{odd} lines are"
        remarks.append(f"{lines_in_words} no frame and left out, the first is line {first_odd}")


def _moment_s(started: re.Match[str]) -> float:
    day, month, year, hour, minute, second, thousandth = (int(part) for part in started.groups())
    moment = datetime.datetime(year, month, day, hour, minute, second)
    return moment.timestamp() + thousandth / 1000


def _of_day_s(moment_s: float) -> float:
    moment = datetime.datetime.fromtimestamp(moment_s)
    return (moment - moment.replace(hour=0, minute=0, second=0, microsecond=0)).total_seconds()


def _since_s(found: re.Match[str]) -> float:
    """The stamp in s; its last part counts tenths of a millisecond."""
    return int(found[1]) * 3600 + int(found[2]) * 60 + int(found[3]) + int(found[4]) / 10_000


def _message(found: re.Match[str], time_s: float, base: int) -> can.Message:
    remote, extended = found[8].endswith("r"), found[8].startswith("x")
    cells = [] if remote else found[10].split()
    return can.Message(
        timestamp=time_s,
        arbitration_id=int(found[7], 16 if found[7].startswith("0x") else base),
        is_extended_id=extended,
        is_remote_frame=remote,
        is_rx=found[5] == "Rx",
        dlc=int(found[9]),
        data=bytes(int(cell, base) for cell in cells),
        channel=found[6],
        is_fd=len(cells) > 8,
    )
