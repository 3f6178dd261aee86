"""What the stamps of an ASC log count from: the log's begin, each trigger block's own begin, or midnight.

python-can takes each trigger block's date for the zero of its stamps. CANoe counts from the begin of the
measurement, others from the block's, BusMaster writes the time of day. The dates in the file decide.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import can

from hil.core.can_logs._log import Stamps
from hil.core.errors import BadInputError

_DATE = re.compile(r"^date\s+\w+\s+(.+?)\s*$", re.IGNORECASE | re.MULTILINE)
_BLOCK = re.compile(r"^\s*begin\s+trigger\s?block\s+\w+\s+(.+?)\s*$", re.IGNORECASE)
_STAMP = re.compile(r"\s*(\d+\.\d+)(?=\s)")
_DAY_S = 86_400.0
_EARLY_S = 2.0  # that dates in whole seconds may differ from stamps
_NEAR_S = 300.0  # between the date of a log and its first stamp, if that is a time of day
_SMALL_HOURS_S = 600.0  # of a day, in which a stamp may be either


@dataclass
class _Block:
    """Stamps of a trigger block in the order of the file; `date_s`: of its begin, NaN if there is none."""

    date_s: float
    first_line: int
    stamps: list[float] = field(default_factory=list)


def on_one_clock(text: str, stamps: Stamps, where: str, remarks: list[str]) -> str:
    """An ASC log whose stamps all count from one date, that of its head or of its first trigger block.

    Args:
        stamps: "log" or "block" state what the stamps of trigger blocks count from.

    Raises:
        BadInputError: there are several trigger blocks, and both or neither of the two may be.
    """
    lines = text.splitlines(keepends=True)
    blocks = _blocks(lines)
    head_s = _head_s(text)
    dated = [block.date_s for block in blocks if block.date_s == block.date_s]
    began_s = head_s if head_s is not None else dated[0] if dated else None
    if not blocks or began_s is None:
        return text
    if _is_time_of_day(blocks[0].stamps[0], began_s):
        remarks.append("its stamps are times of day, as BusMaster writes them: they count from midnight")
        return "".join(_moved(lines, blocks, [-_of_day(began_s)] * len(blocks), keeps=head_s is None))
    if head_s is not None and dated and dated[0] < head_s - _EARLY_S:
        head_s, began_s = None, dated[0]  # the head's is the date on which the file was written
    if not dated or (len(dated) == 1 and not _counts_from_head(blocks, began_s, stamps, remarks)):
        return text  # its one block has the date from which stamps count, as python-can takes it
    shifts = _shifts(blocks, began_s, stamps, where, remarks)
    return "".join(_moved(lines, blocks, shifts, keeps=head_s is None))


def _counts_from_head(blocks: list[_Block], began_s: float, stamps: Stamps, remarks: list[str]) -> bool:
    """Whether stamps of a log with one trigger block count from its head's date, not from the block's."""
    after_s, first_s = blocks[-1].date_s - began_s, blocks[-1].stamps[0]
    if abs(after_s) <= _EARLY_S or stamps == "block":
        return False
    nearer = first_s >= after_s - _EARLY_S and abs(first_s - after_s) < 0.5 * first_s
    if stamps != "log" and not nearer:
        remarks.append(
            f"its trigger block is {after_s:.6g} s after its head: stamps count from the block's date"
        )
    return stamps == "log" or nearer


def _head_s(text: str) -> float | None:
    found = _DATE.search(text[: 1 << 16])
    return None if found is None else _seconds(found[1])


def _seconds(date: str) -> float | None:
    """Seconds since 1970 of a date without its weekday; None if it is none that python-can knows."""
    try:
        return float(can.ASCReader._datetime_to_timestamp(date))
    except ValueError:
        return None


def _blocks(lines: list[str]) -> list[_Block]:
    """Stamps before the first trigger block, if there are any, and those of each block."""
    blocks = [_Block(float("nan"), 0)]
    for number, line in enumerate(lines):
        begin = _BLOCK.match(line)
        if begin is not None:
            date_s = _seconds(begin[1])
            blocks.append(_Block(float("nan") if date_s is None else date_s, number))
            continue
        stamp = _STAMP.match(line)
        if stamp is not None:
            blocks[-1].stamps.append(float(stamp[1]))
    return [block for block in blocks if block.stamps]


def _shifts(
    blocks: list[_Block], began_s: float, stamps: Stamps, where: str, remarks: list[str]
) -> list[float]:
    """What to add to the stamps of each block so that they count from `began_s`."""
    later = [block for block in blocks if block.date_s == block.date_s]
    own = [0.0 if block.date_s != block.date_s else block.date_s - began_s for block in blocks]
    if all(abs(shift) <= _EARLY_S for shift in own):
        if len(later) > 1:
            remarks.append(f"has {len(later)} trigger blocks of one date: their stamps count from there")
        return [0.0] * len(blocks)
    what = f"has {len(later)} trigger blocks" if len(later) > 1 else "has a trigger block after its begin"
    if stamps != "log" and (stamps == "block" or _counts_from_blocks(blocks, own, what, where)):
        remarks.append(f"{what}: stamps count from each block's own date")
        return own
    remarks.append(f"{what}: stamps count from the log's begin")
    return [0.0] * len(blocks)


def _counts_from_blocks(blocks: list[_Block], own: list[float], what: str, where: str) -> bool:
    """Whether stamps count from each block's date: they follow it more closely than the log's.

    Raises:
        BadInputError: the stamps follow neither closely, or contradict both.
    """
    moved = [(shift, block.stamps) for shift, block in zip(own, blocks, strict=True) if shift > _EARLY_S]
    from_log_s = max((abs(stamps[0] - shift) for shift, stamps in moved), default=0.0)
    from_block_s = max((abs(stamps[0]) for _, stamps in moved), default=0.0)
    rises = all(a.stamps[-1] <= b.stamps[0] + _EARLY_S for a, b in itertools.pairwise(blocks))
    ends = [shift + block.stamps[-1] for shift, block in zip(own, blocks, strict=True)]
    in_turn = all(end <= begin + _EARLY_S for end, begin in zip(ends[:-1], own[1:], strict=True))
    may_be_log = rises and all(stamps[0] >= shift - _EARLY_S for shift, stamps in moved)
    if may_be_log != in_turn:
        return in_turn
    nearer, farther = sorted((from_log_s, from_block_s))
    if may_be_log and nearer + _EARLY_S < 0.5 * farther:
        return from_block_s < from_log_s
    raise BadInputError(
        f"{what}, and their dates and stamps "
        + ("fit the log's begin and each block's alike" if may_be_log else "contradict each other"),
        where=where,
        fix="--stamps log: stamps count from the log's begin; --stamps block: from each block's date",
    )


def _of_day(moment_s: float) -> float:
    """Seconds since midnight, local time, as the date in the log is written."""
    import datetime

    moment = datetime.datetime.fromtimestamp(moment_s)
    midnight = moment.replace(hour=0, minute=0, second=0, microsecond=0)
    return (moment - midnight).total_seconds()


def _is_time_of_day(stamp_s: float, began_s: float) -> bool:
    of_day_s = _of_day(began_s)
    return of_day_s > _SMALL_HOURS_S and -_EARLY_S <= stamp_s - of_day_s < _NEAR_S


def _moved(lines: list[str], blocks: list[_Block], shifts: list[float], *, keeps: bool) -> Iterator[str]:
    """Lines with their stamps moved; a time of day that goes back by half a day has passed midnight.

    Args:
        keeps: the first line of a trigger block stays, and gives the date that stamps count from.
    """
    at = -1
    newest_s, days = 0.0, 0
    begins = [block.first_line for block in blocks]
    for number, line in enumerate(lines):
        while at + 1 < len(begins) and number >= begins[at + 1]:
            at += 1
        if _BLOCK.match(line):
            if keeps:
                yield line
            keeps = False
            continue
        stamp = _STAMP.match(line)
        if stamp is None or at < 0:
            yield line
            continue
        stamp_s = float(stamp[1])
        if shifts[at] < 0.0:
            days += stamp_s < newest_s - 0.5 * _DAY_S
            newest_s = stamp_s
        moved_s = max(0.0, stamp_s + shifts[at] + days * _DAY_S)
        yield line if moved_s == stamp_s else f"{moved_s:.9f}{line[stamp.end() :]}"
