from hypothesis import given
from hypothesis import strategies as st

from hil.core.printable import is_printable, printable


def test_what_would_move_a_terminal_is_escaped():
    assert printable("a\x1b[31mb\nc\x9b\u202e") == r"a\x1b[31mb\nc\x9b\u202e"
    assert printable("ω_m, N·m") == "ω_m, N·m"


@given(st.text())
def test_what_is_shown_can_be_printed_and_is_short(text):
    assert is_printable(printable(text, 20))
    assert len(printable(text, 20)) <= 20
