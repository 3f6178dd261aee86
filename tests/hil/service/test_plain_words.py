"""Errors of commands as people at the page read them: no places of the machine, no lone options."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.service.plain_words import in_plain_words, names_in, without_folders


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
        ("choose with --segment, or run a plan; segments: s", "run a plan; segments: s"),
        ("give --columns, or another file", "give the columns, or another file"),
        ("see https://example.org/a/b", "see https://example.org/a/b"),
    ],
)
def test_a_message_is_worded_for_the_page(text: str, plain: str) -> None:
    assert in_plain_words(text, {"/data/runs/000012/recording.mcap": "the recording of run 12"}) == plain


def test_an_option_that_has_no_field_is_called_one_of_a_command() -> None:
    found = in_plain_words("record longer, or widen the band with --from-hz and --to-hz", {})
    assert found.startswith("record longer, or widen the band with --from-hz and --to-hz (options with --")


def test_a_path_that_somebody_wrote_stays_where_files_are_named_by_their_paths() -> None:
    asked = {"path": "/data/models/a.toml", "models": {"b": "/data/models/b.toml"}, "text": "dbc = '/x/y'"}
    text = "/data/models/b.toml: dbc = '/etc/passwd' is not a name alone"
    plain = in_plain_words(text, names_in(asked), hide_places=False)
    assert plain == "b.toml: dbc = '/etc/passwd' is not a name alone"


def test_files_below_the_folder_of_the_service_are_called_by_their_names(tmp_path: Path) -> None:
    text = f"{tmp_path}/given/plans/short.yaml: line 4; {tmp_path}/x.toml; /etc/passwd"
    assert without_folders(text, [tmp_path]) == "short.yaml: line 4; x.toml; /etc/passwd"
