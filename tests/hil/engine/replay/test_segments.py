"""Segments as a person says them."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.engine.replay._segments import Segments, segments_from

ONE = '{"id": "a", "start_s": 1.0, "step_s": 2.0, "end_s": 3.0}'


@pytest.mark.parametrize("text", [f"[{ONE}]", f'{{"segments": [{ONE}], "verdict": "pass"}}'])
def test_a_list_or_a_result(tmp_path: Path, text: str) -> None:
    path = tmp_path / "segments.json"
    path.write_text(text)
    (segment,) = segments_from(path).on(123)
    assert (segment.id, segment.start_s, segment.step_s, segment.end_s) == ("a", 1.0, 2.0, 3.0)


def test_times_of_another_moment_are_moved(tmp_path: Path) -> None:
    path = tmp_path / "segments.json"
    path.write_text(f"[{ONE}]")
    told = Segments(segments_from(path).segments, row_0_ns=5_000_000_000)
    (segment,) = told.on(4_500_000_000)
    assert (segment.start_s, segment.step_s, segment.end_s) == (1.5, 2.5, 3.5)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("{}", "has no segments"),
        ("hello", "has no segments"),
        ('[{"id": "a"}]', "0.start_s"),
        (f"[{ONE.replace('2.0', '9.0')}]", "does not satisfy start_s <= step_s"),
    ],
)
def test_what_says_nothing_is_refused(tmp_path: Path, text: str, what: str) -> None:
    path = tmp_path / "segments.json"
    path.write_text(text)
    with pytest.raises(BadInputError, match=what):
        segments_from(path)
