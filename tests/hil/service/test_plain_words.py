"""Errors of commands as people at the page read them: no places of the machine, no lone options."""

from __future__ import annotations

import pytest

from hil.service.plain_words import in_plain_words


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("/data/runs/000012/recording.mcap: too short", "the recording of run 12: too short"),
        ("/data/given/plans/p.yaml, line 3: unknown key", "p.yaml, line 3: unknown key"),
        ("state which it is: --columns 'a=COLUMN'", "state which it is: the columns 'a=COLUMN'"),
        ("give another one to --holdout", "give another one to the held-out recordings"),
        ("2 of 10 min (--at-most)", "2 of 10 min (the time limit)"),
        ("run 'hil identify --from-hz 1' first", "run 'hil identify --from-hz 1' first"),
        ("5 km/h and 3 rad/s, and/or 1 /s", "5 km/h and 3 rad/s, and/or 1 /s"),
        ("see https://example.org/a/b", "see https://example.org/a/b"),
    ],
)
def test_a_message_is_worded_for_the_page(text: str, plain: str) -> None:
    assert in_plain_words(text, {"/data/runs/000012/recording.mcap": "the recording of run 12"}) == plain


def test_an_option_that_has_no_field_is_called_one_of_a_command() -> None:
    found = in_plain_words("record longer, or widen the band with --from-hz and --to-hz")
    assert found.startswith("record longer, or widen the band with --from-hz and --to-hz (options with --")
