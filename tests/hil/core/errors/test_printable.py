from hypothesis import given
from hypothesis import strategies as st

from hil.core.errors.wording import is_printable, printable


def test_what_would_move_a_terminal_is_escaped():
    assert printable("a\x1b[31mb\nc\x9b\u202e") == r"a\x1b[31mb\nc\x9b\u202e"
    assert printable("ω_m, N·m") == "ω_m, N·m"


@given(st.text())
def test_what_is_shown_can_be_printed_and_is_short(text):
    assert is_printable(printable(text, 20))
    assert len(printable(text, 20)) <= 20


def test_long_text_is_cut_with_a_sign():
    assert printable("x" * 80) == "x" * 80
    assert printable("x" * 81) == "x" * 79 + "…"
    assert printable("abcdef", 6) == "abcdef"
    assert printable("abcdefg", 6) == "abcde…"
