"""Pipes that no one waits at: a reader that stands still holds up no one, one that is gone is noticed."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator

import pytest

from hil.core.errors import BenchError
from hil.engine.ipc.ipc_messages import Here, Message, OperatorText, Turned
from hil.engine.ipc.ipc_pipe import MOST_WAITING_BYTES, IpcPipe

Pair = tuple[IpcPipe, IpcPipe]


@pytest.fixture
def pair() -> Iterator[Pair]:
    one, other = os.pipe(), os.pipe()
    ends = IpcPipe(one[0], other[1]), IpcPipe(other[0], one[1])
    yield ends
    for end in ends:
        end.close()


def test_messages_arrive_in_their_order(pair: Pair):
    here, there = pair
    assert there.fetch() == []
    here.send(OperatorText(text="a"))
    here.send(Turned())
    there.wait(1.0)
    assert there.fetch() == [OperatorText(text="a"), Turned()]
    assert not there.gone


def test_a_reader_that_stands_still_holds_up_nobody_and_gets_all_of_it(pair: Pair):
    here, there = pair
    texts = [f"{number} " + "x" * 50_000 for number in range(100)]
    for text in texts:
        here.send(OperatorText(text=text))
    assert here.crowded
    here.send_if_idle(Here())  # worth nothing later
    assert not here.push_all(0.05)
    found: list[Message] = []
    while len(found) < len(texts):
        found += there.fetch()
        here.push()
    assert [message.text for message in found if isinstance(message, OperatorText)] == texts
    assert here.push_all(0.0)
    assert there.fetch() == []
    assert len(texts) * 50_000 > MOST_WAITING_BYTES


def test_the_last_words_wait_for_a_reader_that_comes_late(pair: Pair):
    here, there = pair
    here.send(OperatorText(text="y" * 1_000_000))
    found: list[object] = []

    def read() -> None:
        while not found:
            there.wait(1.0)
            found.extend(there.fetch())

    reader = threading.Thread(target=read)
    reader.start()
    assert here.push_all(20.0)
    reader.join()
    assert len(found) == 1


def test_an_end_that_is_closed_is_noticed_and_what_it_said_is_read(pair: Pair):
    here, there = pair
    here.send(OperatorText(text="last"))
    here.close()
    assert there.fetch() == [OperatorText(text="last")]
    assert there.gone
    there.send(Here())
    assert there.push_all(0.1) is False


def test_what_is_no_message_is_refused():
    reading, writing = os.pipe()
    end = IpcPipe(reading, os.dup(writing))
    os.write(writing, b"hello\n")
    with pytest.raises(BenchError, match="cannot be understood"):
        end.fetch()
    os.close(writing)
    end.close()
