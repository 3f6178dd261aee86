"""A CAN bus as the drivers see it: send a frame, take all that has come, keep both for the recording."""

from __future__ import annotations

import errno
import logging
from typing import Any

import can
import numpy as np
import numpy.typing as npt

from drivers.bus_health import BusHealth
from drivers.echoes import Echoes
from hil.core.can.frames import (
    ERROR_FRAME,
    EXTENDED,
    FRAME,
    SENT_BY_HOST,
    FrameBlock,
    empty_block,
    frames,
    inserted,
    joined,
)
from hil.core.can.signals import Payloads
from hil.core.errors import BenchError
from hil.core.errors.wording import printable
from hil.core.runtime.clock import Clock

_LOG = logging.getLogger(__name__)

_LONGEST_DATA = 8
# Of a stamp, before it is the clock's doing: frames come late when something is busy, but never too early.
_AHEAD_S, _BEHIND_S = 0.5, 5.0
_LEARNS_S = 0.1  # what came before the bus was opened says nothing of the clock
_DRIFT = 1e-3  # no adapter's clock is worse
_OTHER_CLOCK_S = 10.0  # stamps that are further off are none since 1970, but of the adapter's own clock

# What drivers and adapters say of why nothing passes, in words
_GONE = "the adapter is gone: unplugged, or its driver was unloaded"
_FULL = "the transmit queue is full: frames are not sent; check that another node acknowledges them"
_CLOSED = "the other end is no longer connected"
_REASONS = {
    errno.ENETDOWN: "the network interface is down",
    errno.ENXIO: _GONE,
    errno.ENODEV: _GONE,
    errno.EIO: _GONE,
    errno.EBADF: _GONE,
    errno.ENOBUFS: _FULL,
    errno.EAGAIN: _FULL,
    errno.ECONNREFUSED: _CLOSED,
    errno.ECONNRESET: _CLOSED,
    errno.EPIPE: _CLOSED,
}
_FIX = (
    "check the CAN adapter, its cable and terminators (120 ohm at both ends), and the bit rate of all nodes"
)
_CLOCK_FIX = "do not set the computer's clock during a run; slew it (chrony, ntpd -x)"
_FULL_WORDS = ("buffer full", "queue full", "queue is full", "buffer overflow", "QXMTFULL", "XMTFULL")


class Wire:
    """One bus, used from one thread, without a receive thread that could die unseen.

    A bus that has a `recv_block` of its own (see `hil.core.can.frames`) is drained with it, or with
    `recv_epoch_block`, whose stamps count from 1970; any other message by message. A bus that has
    `send_frame(id, data)` is given no message object. The result is the same.

    Frames that no device of a bench sends are left out and logged: remote frames, and CAN FD frames
    of more than 8 bytes.

    Args:
        epoch_offset_s: time stamps of messages (since 1970) minus clock time, in wall-clock seconds.
        time_scale: seconds of the clock in a second of the time stamps.
        health: looks at error frames and at what the adapter says of itself.
        echoing: whether the bus gives own frames back; they are no received frames, see `echoes`.
    """

    def __init__(
        self,
        name: str,
        bus: can.BusABC,
        clock: Clock,
        *,
        epoch_offset_s: float = 0.0,
        time_scale: float = 1.0,
        health: BusHealth | None = None,
        echoing: bool = False,
    ) -> None:
        self.name = name
        self.echoes = Echoes() if echoing else None
        self._bus = bus
        self._clock = clock
        self._epoch_offset_s, self._time_scale = epoch_offset_s, time_scale
        self._health = health or BusHealth(name)
        self._stamped = False
        # By how much stamps are behind at least, when that was looked at last, and what is added to them
        self._lag_s, self._drained_s, self._jumped_s = 0.0, 0.0, 0.0
        self._learns_until_s: float | None = None
        self._jumps: list[str] = []
        self._left_out: set[str] = set()
        self._sent: list[tuple[float, int, int, int, int]] = []
        self._sent_ahead: list[FrameBlock] = []
        self._take: Any = getattr(bus, "recv_block", self._take_one_by_one)
        self._take_stamped: Any = getattr(bus, "recv_epoch_block", None)
        self._put: Any = getattr(bus, "send_frame", self._put_message)
        self._put_ahead: Any = getattr(bus, "send_ahead", None)

    def send(self, frame_id: int, data: bytes) -> None:
        """Put one standard data frame on the bus.

        Raises:
            BenchError: the bus does not take it (unplugged, down, bus-off, queue full).
        """
        try:
            self._put(frame_id, data)
        except (can.CanError, OSError) as error:
            raise self._failed("sending", error) from error
        payload = int.from_bytes(data, "little")
        self._sent.append((self._clock.now_s(), frame_id, SENT_BY_HOST, len(data), payload))
        if self.echoes:
            self.echoes.expect(frame_id, payload)

    @property
    def last_sent(self) -> tuple[float, int, int] | None:
        """Time on the clock (s), identifier and payload of the newest frame that no `drain` has taken yet."""
        if not self._sent:
            return None
        time_s, frame_id, _, _, payload = self._sent[-1]
        return time_s, frame_id, payload

    @property
    def takes_ahead(self) -> bool:
        """Whether frames can be handed over before their time."""
        return self._put_ahead is not None

    def send_ahead(
        self, frame_id: int, payloads: Payloads, length: int, times_s: npt.NDArray[np.float64]
    ) -> None:
        """Put standard data frames on a bus that `takes_ahead`, each at its time, s of the clock."""
        self._put_ahead(frame_id, payloads, length, times_s)
        self._sent_ahead.append(frames(frame_id, payloads, length, times_s, flags=SENT_BY_HOST))

    def drain(self) -> FrameBlock:
        """Every frame that came since the last call, in that order, and between them those sent."""
        try:
            block: FrameBlock = self._take_block() if self._take_stamped is not None else self._take()
        except (can.CanError, OSError) as error:
            raise self._failed("receiving", error) from error
        if len(block):
            block = self._steady(block)
        sent = self._taken_sent()
        return block if sent is None else inserted(sent, block) if len(block) else sent

    def _steady(self, block: FrameBlock) -> FrameBlock:
        """Frames with the stamps that they would have had if the adapter's clock had not jumped.

        An old frame must not be taken for news, nor news for an old frame: the way to the safe state is read
        back by them. `check` reports that it jumped.
        """
        now_s = self._clock.now_s()
        if self._jumped_s:
            block["time_s"] += self._jumped_s
        lag_s = now_s - float(block["time_s"][-1])
        since_s, self._drained_s = now_s - self._drained_s, now_s
        if self._learns_until_s is None:
            self._learns_until_s, self._lag_s = now_s + _LEARNS_S, lag_s
        jump_s = lag_s - self._lag_s
        if now_s < self._learns_until_s or not self._is_jump(jump_s, since_s):
            # Frames may be late by any cause, and in time again: the least lag is what the clock says.
            self._lag_s += min(jump_s, _DRIFT * since_s)
            return block
        self._jumps.append(f"the adapter's clock has jumped by {-jump_s:.1f} s")
        self._jumped_s += jump_s
        beyond = np.abs(now_s - block["time_s"] - self._lag_s) > 0.5 * abs(jump_s)
        block["time_s"][beyond] += jump_s
        return block

    @staticmethod
    def _is_jump(jump_s: float, since_s: float) -> bool:
        """Whether stamps are further ahead than any delay explains, or further behind."""
        return jump_s < -_AHEAD_S or jump_s > _BEHIND_S + since_s

    def _taken_sent(self) -> FrameBlock | None:
        """What was sent since the last call, in order of time."""
        blocks, self._sent_ahead = self._sent_ahead, []
        if self._sent:
            blocks.append(np.array(self._sent, FRAME))
            self._sent = []
        if len(blocks) < 2:
            return blocks[0] if blocks else None
        sent = joined(blocks)
        return sent[np.argsort(sent["time_s"], kind="stable")]

    @property
    def remarks(self) -> list[str]:
        """What was seen on the bus so far that ends no run but belongs to its record."""
        lost = getattr(self._bus, "lost", 0)
        lines = [f"{what} were left out" for what in sorted(self._left_out)] + self._health.remarks
        return [*lines, f"{lost} frames were lost on the way"] if lost else lines

    def check(self) -> None:
        """Look at what the adapter says of the bus; each fault is raised once.

        Raises:
            BenchError: bus-off, error-passive, a transmit queue that is full, stamps that have jumped.
        """
        try:
            faults = self._health.new_faults(self._clock.now_s())
        except (can.CanError, OSError) as error:
            raise self._failed("reading its state", error) from error
        if faults:
            raise BenchError("; ".join(faults), where=f"bus '{self.name}'", fix=_FIX)
        if self._jumps:
            jumps, self._jumps = self._jumps, []
            raise BenchError("; ".join(jumps), where=f"bus '{self.name}'", fix=_CLOCK_FIX)

    def close(self) -> None:
        """Leave the bus."""
        try:
            self._bus.shutdown()
        except (can.CanError, OSError):  # what is gone need not be left
            _LOG.info("bus '%s' cannot be closed", self.name, exc_info=True)

    def _put_message(self, frame_id: int, data: bytes) -> None:
        self._bus.send(can.Message(arbitration_id=frame_id, data=data, is_extended_id=False, check=False))

    def _take_block(self) -> FrameBlock:
        block: FrameBlock = self._take_stamped()
        if len(block):
            block["time_s"] = (block["time_s"] - self._epoch_offset_s) * self._time_scale
        return self.echoes.others(block) if self.echoes else block

    def _take_one_by_one(self) -> FrameBlock:
        found = []
        while (message := self._bus.recv(0)) is not None:
            data = message.data
            if message.is_error_frame:
                self._health.take(message)
            elif message.is_remote_frame:
                self._leave_out("remote frames")
                continue
            elif len(data) > _LONGEST_DATA:
                self._leave_out("CAN FD frames of more than 8 bytes")
                continue
            flags = EXTENDED * message.is_extended_id | ERROR_FRAME * message.is_error_frame
            payload = int.from_bytes(data, "little")
            stamp_s = self._bench_time(message.timestamp)
            if (
                not message.is_rx
                and self.echoes
                and self.echoes.take(stamp_s, message.arbitration_id, payload)
            ):
                continue
            found.append((stamp_s, message.arbitration_id, flags, len(data), payload))
        return np.array(found, FRAME) if found else empty_block()

    def _bench_time(self, stamp: float) -> float:
        if not self._stamped:
            self._stamped = True
            ahead_s = stamp - self._epoch_offset_s - self._clock.now_s() / self._time_scale
            if abs(ahead_s) > _OTHER_CLOCK_S:
                _LOG.info("bus '%s': stamps count from a moment of the adapter's own", self.name)
                self._epoch_offset_s += ahead_s
        return (stamp - self._epoch_offset_s) * self._time_scale

    def _leave_out(self, what: str) -> None:
        if what not in self._left_out:
            self._left_out.add(what)
            _LOG.warning("bus '%s': %s are left out", self.name, what)

    def _failed(self, doing: str, error: Exception) -> BenchError:
        library_text = printable(str(error).strip(), 200)
        reason = _reason(error)
        return BenchError(
            f"{doing} failed: {reason} ({library_text})" if reason else f"{doing} failed: {library_text}",
            where=f"bus '{self.name}'",
            fix=_FIX,
        )


def _reason(error: Exception) -> str:
    """Why, in words; '' if only the adapter's software knows."""
    link: BaseException | None = error
    while link is not None:
        number = getattr(link, "error_code", None) or getattr(link, "errno", None)
        if number in _REASONS and isinstance(link, OSError | can.CanError):
            return _REASONS[number]
        link = link.__cause__ or link.__context__
    return _FULL if any(words.lower() in str(error).lower() for words in _FULL_WORDS) else ""
