"""Of several failures the first is what stopped the run; an emergency stop is above all."""

from __future__ import annotations

import pytest

from hil.core.errors import (
    BadInputError,
    BenchError,
    EmergencyStopError,
    HilError,
    InterruptError,
    OrderlyEndError,
)
from hil.engine.run.run_monitoring import Failures

Events = list[tuple[str, str]]


def failures(blame: str = "") -> tuple[Failures, Events]:
    events: Events = []
    return Failures(lambda kind, text: events.append((kind, text)), lambda: blame), events


@pytest.mark.parametrize(
    ("errors", "said", "kinds"),
    [
        ([BenchError("a"), BenchError("b")], "a", ["failure"]),
        ([InterruptError("a"), BenchError("b")], "a", ["interrupt"]),
        ([BadInputError("a", where="x", fix="do y")], "x: a do y", ["failure"]),
        ([BenchError("a"), EmergencyStopError("e", by="me")], "emergency stop: e",
         ["failure", "emergency_stop"]),
        ([KeyError("a"), BenchError("b")], "internal error: KeyError: 'a' please report it",
         ["traceback", "failure"]),
        ([BenchError("a"), ValueError("b")], "a", ["failure", "traceback"]),
    ],
)  # fmt: skip
def test_which_one_is_told(errors: list[Exception], said: str, kinds: list[str]) -> None:
    kept, events = failures()
    for error in errors:
        kept.take(error)
    assert " ".join(str(kept.error).split()) == said
    assert [kind for kind, _ in events] == kinds
    assert all("\n" not in text for kind, text in events if kind != "traceback")


@pytest.mark.parametrize(
    ("error", "blamed"),
    [
        (BenchError("the dynos fault"), True),
        (BenchError("the bench loop was delayed by 0.7 s"), False),  # says so itself
        (OrderlyEndError("too hot"), False),
        (InterruptError("q"), False),
        (EmergencyStopError("e", by="me"), False),
    ],
)
def test_a_loop_that_stood_still_is_named_as_what_may_have_been_the_cause(
    error: HilError, blamed: bool
) -> None:
    kept, _ = failures("the bench loop was delayed by 0.06 s just before")
    kept.take(error)
    assert kept.error is not None
    assert ("just before" in kept.error.what) is blamed
    assert type(kept.error) is type(error)


def test_where_a_mistake_happened_is_recorded() -> None:
    kept, events = failures()
    try:
        raise KeyError("duty")
    except KeyError as error:
        kept.note(error)
    assert kept.error is None
    assert "test_failures.py" in events[0][1]


def test_a_recording_that_takes_nothing_any_more_hides_no_failure() -> None:
    def full(kind: str, text: str) -> None:
        raise BenchError("disk full")

    kept = Failures(full, lambda: "")
    kept.take(BenchError("a"))
    assert str(kept.error) == "a"
