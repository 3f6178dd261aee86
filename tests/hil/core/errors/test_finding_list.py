"""Lists of findings that end where no one reads any more."""

from __future__ import annotations

from hil.core.errors.wording import MOST_CHARACTERS, listed, repeated


def test_a_few_are_all_told_with_their_own_lines_indented() -> None:
    assert (
        listed(["line 3: one", "line 9: two\nmore of it"]) == "\n  line 3: one\n  line 9: two\n  more of it"
    )
    assert listed([]) == ""


def test_of_very_many_the_first_are_told_and_the_rest_counted() -> None:
    told = listed([f"line {number}: {'x' * 190}" for number in range(100)])
    lines = told.splitlines()[1:]
    assert MOST_CHARACTERS - 300 < len(told) < MOST_CHARACTERS + 100
    assert lines[-1] == f"  and {100 - (len(lines) - 1)} more, when these are corrected"
    assert lines[0].startswith("  line 0: ")


def test_the_first_is_told_however_long_it_is() -> None:
    first = "x" * (2 * MOST_CHARACTERS)
    assert listed([first, "y"]) == f"\n  {first}\n  and 1 more, when these are corrected"


def test_names_that_stand_twice_are_found_in_one_pass() -> None:
    assert repeated(["b", "a", "b", "c", "a", "b"]) == ["a", "b"]
    assert repeated(str(number) for number in range(300_000)) == []  # their square would take an hour
