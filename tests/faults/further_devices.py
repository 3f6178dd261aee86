"""Faults of the panel's serial line and of XCP, and where they are put in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivers import SerialLine
from hil.core.ak import BUSY, SYNTAX, UNKNOWN, Answer, Telegrams, request_of
from hil.core.can.frames import FrameBlock, frames, joined
from hil.core.can.xcp import ERROR, EVENT, LARGEST_ODT_NUMBER, Code, Happened
from hil.core.errors import BenchError
from sim_backend.rcs import EmulatedPanel
from tests.faults.stage import Injection, Stage

ANSWER_ID = 0x551
_PACKET, _BYTE = np.uint64(0xFF), np.uint64(8)

# --- the panel ---


@dataclass
class PanelSays(Injection):
    """The panel says something else to what it hears, for a time. `change`: panel, what came, its answer."""

    change: Callable[[EmulatedPanel, bytes, bytes], bytes]
    for_s: float = np.inf

    def plug(self, stage: Stage) -> None:
        hear = EmulatedPanel.hear

        def heard(panel: EmulatedPanel, data: bytes) -> bytes:
            said = hear(panel, data)
            if stage.injected_s is None or stage.now_s > stage.injected_s + self.for_s:
                return said
            other = self.change(panel, data, said)
            stage.count(other != said)
            return other

        EmulatedPanel.hear = heard  # type: ignore[method-assign, assignment]


@dataclass
class PanelIs(Injection):
    """The panel is brought into another state, once."""

    work: Callable[[EmulatedPanel], None]

    def plug(self, stage: Stage) -> None:
        hear = EmulatedPanel.hear

        def heard(panel: EmulatedPanel, data: bytes) -> bytes:
            if stage.injected_s is not None:
                self.work(panel)
                stage.count()
            return hear(panel, data)

        EmulatedPanel.hear = heard  # type: ignore[method-assign, assignment]


@dataclass
class LineAway(Injection):
    """The adapter of the serial line is pulled out, and put in again after a time."""

    for_s: float = np.inf

    def plug(self, stage: Stage) -> None:
        send, drain, begin = SerialLine.send, SerialLine.drain, SerialLine.__init__

        def look() -> None:
            if stage.injected_s is not None and stage.now_s <= stage.injected_s + self.for_s:
                stage.count()
                raise BenchError("device reports readiness to read but returned no data", where="panel")

        def sends(line: SerialLine, data: bytes) -> None:
            look()
            send(line, data)

        def drains(line: SerialLine) -> bytes:
            look()
            return drain(line)

        def begins(line: SerialLine, name: str, url: str, baud_rate: int = 115_200) -> None:
            look()
            begin(line, name, url, baud_rate)

        line_class: Any = SerialLine
        line_class.send, line_class.drain, line_class.__init__ = sends, drains, begins


def nothing_said(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
    return b""


def among_garbage(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
    """Noise, an echo, half a telegram before the answer, half of one behind it."""
    return b"\xff\x00\x03noise" + data + b"\x02 AST" + said + b"\x02 ASTF 0"


def only_noise(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
    return bytes(np.random.default_rng(len(data)).integers(0, 256, 40, np.uint8))


def half(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
    return (
        said[: len(said) // 2] if said.count(b"\x02") == 1 else said[: said.index(b"\x03")] if said else b""
    )


def echo(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
    return data


def answering(answer: Callable[[str], Answer]) -> Callable[[EmulatedPanel, bytes, bytes], bytes]:
    """The same to every request."""

    def change(panel: EmulatedPanel, data: bytes, said: bytes) -> bytes:
        requests = [request_of(text) for text in Telegrams().feed(data)]
        return b"".join(answer(request.function).telegram() for request in requests if request)

    return change


BUSY_FOR_EVER = answering(lambda function: Answer(function, 1, (BUSY,)))
ERRORS = answering(lambda function: Answer(UNKNOWN, 1, (SYNTAX,)))


def alarm(panel: EmulatedPanel) -> None:
    panel.latched = ["17"]


def local(panel: EmulatedPanel) -> None:
    panel.remote = False


# --- XCP ---


def _answers(block: FrameBlock) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return (block["id"] == ANSWER_ID) & (block["data"] & _PACKET > LARGEST_ODT_NUMBER)


def nothing(block: FrameBlock) -> FrameBlock:
    return block[:0]


def without_answers(block: FrameBlock) -> FrameBlock:
    return block[~_answers(block)]


def zeroed(block: FrameBlock) -> FrameBlock:
    """Answers that say nothing: zeros behind the first byte."""
    block["data"][_answers(block)] &= _PACKET
    return block


def refused(block: FrameBlock) -> FrameBlock:
    place = _answers(block)
    block["data"][place], block["length"][place] = ERROR | Code.GENERIC << 8, 2
    return block


def cut(block: FrameBlock) -> FrameBlock:
    """Every packet of measured data is a byte too short."""
    place = (block["id"] == ANSWER_ID) & ~_answers(block)
    block["length"][place] -= 1
    return block


def same_stamp(block: FrameBlock) -> FrameBlock:
    first = (block["id"] == ANSWER_ID) & (block["data"] & _PACKET == 0)
    block["data"][first] &= ~np.uint64(0xFFFF00)
    return block


def one_of(count: int) -> Callable[[FrameBlock], FrameBlock]:
    """Of so many packets of measured data one is lost, at random."""
    random = np.random.default_rng(5)

    def change(block: FrameBlock) -> FrameBlock:
        return block[_answers(block) | (random.integers(0, count, len(block)) > 0)]

    return change


def overloaded() -> Callable[[FrameBlock], FrameBlock]:
    """Every second packet is missing, and the slave says why."""
    lossy = one_of(2)

    def change(block: FrameBlock) -> FrameBlock:
        told = frames(ANSWER_ID, EVENT | Happened.DAQ_OVERLOAD << 8, 2, float(block["time_s"][-1]))
        return joined([lossy(block), told])

    return change
