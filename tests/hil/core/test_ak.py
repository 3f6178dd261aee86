"""Telegrams, whatever else is on the line."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from hil.core.ak import LONGEST, Answer, Request, Telegrams, answer_of, request_of

CODE = st.text("ABCDEFGHIJKLMNOPQRSTUVWXYZ", min_size=4, max_size=4)
DATA = st.lists(
    st.text(st.characters(min_codepoint=33, max_codepoint=126), min_size=1, max_size=9), max_size=4
).map(tuple)


def heard(*pieces: bytes) -> list[str]:
    telegrams = Telegrams()
    return [text for piece in pieces for text in telegrams.feed(piece)]


@given(CODE, DATA, st.integers(0, 9), st.integers(1, 5))
def test_what_is_sent_in_pieces_is_what_comes(
    code: str, data: tuple[str, ...], number: int, size: int
) -> None:
    request, answer = Request(code, data, number), Answer(code, number, data)
    line = request.telegram() + answer.telegram()
    first, second = heard(*(line[at : at + size] for at in range(0, len(line), size)))
    assert request_of(first) == request
    assert answer_of(second) == answer
    assert request_of(second) is None
    assert answer_of(first) is None  # the echo of a request is no answer


@given(st.lists(st.binary(max_size=40), max_size=8))
def test_any_bytes_give_telegrams_or_nothing(pieces: list[bytes]) -> None:
    for text in heard(*pieces):
        assert len(text) <= LONGEST
        request_of(text)
        answer_of(text)


@given(st.binary(max_size=40).filter(lambda junk: b"\x02" not in junk))
def test_garbage_and_a_half_telegram_before_it_cost_no_whole_one(junk: bytes) -> None:
    whole = Answer("ASTZ", 0, ("SREM",))
    assert answer_of(heard(junk, b"\x02 AST", whole.telegram())[-1]) == whole


def test_what_never_ends_is_no_telegram() -> None:
    assert heard(b"\x02" + b"x" * 10_000, b"\x03") == []


def test_errors_have_a_name() -> None:
    assert Answer("SREM").error == ""
    assert Answer("EMAS", 1, ("DF",)).error == "DF"
    assert Answer("EMAS", 1).error == "SE"
    assert Answer("????", 1, ("SE",)).error == "NA"
