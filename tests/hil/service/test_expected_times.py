"""When queued runs start: order, durations, and what others have reserved."""

from __future__ import annotations

import datetime

import pytest

from hil.api_schemas.api import LeaseData, ReservationData, RunData
from hil.service.expected_times import Expected, blocking, end_of, expected, windows_of

NOW = datetime.datetime(2026, 11, 28, 8, 0, tzinfo=datetime.UTC)


def at(minutes: float) -> datetime.datetime:
    return NOW + datetime.timedelta(minutes=minutes)


def run(number: int, who: str = "anna") -> RunData:
    return RunData(
        id=number, plan="p", title="", bench="rig", state="queued", values={}, priority=0, requested_by=who,
        queued_at=NOW,
    )  # fmt: skip


def reserved(
    begins: float, ends: float, who: str = "bert", admitted: tuple[int, ...] = ()
) -> ReservationData:
    return ReservationData(
        id=1, bench="rig", who=who, begins=at(begins), ends=at(ends), reason="r", admitted=list(admitted)
    )


def spans(found: dict[int, Expected]) -> dict[int, tuple[float | None, float | None]]:
    def minutes(moment: datetime.datetime | None) -> float | None:
        return None if moment is None else (moment - NOW).total_seconds() / 60

    return {number: (minutes(one.start), minutes(one.end)) for number, one in found.items()}


def test_one_after_the_other_from_when_the_bench_is_free() -> None:
    seconds = {1: 600.0, 2: 60.0}
    queue = [run(1), run(2), run(3), run(4)]
    assert spans(expected(queue, [], NOW, at(5), seconds.get)) == {
        1: (5, 15), 2: (15, 16), 3: (16, None), 4: (None, None),
    }  # fmt: skip
    assert spans(expected(queue[:1], [], NOW, None, seconds.get)) == {1: (None, None)}
    assert expected([], [], NOW, NOW, seconds.get) == {}


def test_a_run_waits_for_the_reservation_of_another_and_one_of_its_own_goes_first() -> None:
    windows = windows_of([reserved(-10, 30)], None, NOW)
    found = expected([run(1), run(2, "bert"), run(3)], windows, NOW, NOW, {1: 60.0, 2: 120.0, 3: 60.0}.get)
    assert spans(found) == {2: (0, 2), 1: (30, 31), 3: (31, 32)}
    assert found[1].waits_for == windows[0].reservation
    assert found[2].waits_for is None


def test_a_run_that_was_admitted_starts() -> None:
    windows = windows_of([reserved(-10, 30, admitted=(3,))], None, NOW)
    found = expected([run(1), run(3)], windows, NOW, NOW, lambda _: 60.0)
    assert spans(found) == {3: (0, 1), 1: (30, 31)}


def test_a_run_that_would_reach_into_a_reservation_waits_and_a_shorter_one_does_not() -> None:
    windows = windows_of([reserved(10, 30)], None, NOW)
    seconds = {1: 1200.0, 2: 300.0}
    found = expected([run(1), run(2), run(3)], windows, NOW, NOW, seconds.get)
    assert spans(found) == {2: (0, 5), 3: (5, None), 1: (None, None)}
    assert found[1].waits_for == windows[0].reservation
    assert blocking(run(2), windows, NOW, 600.0) is None  # it ends as the reservation begins
    assert blocking(run(2), windows, at(30), 600.0) is None


def test_a_lease_is_a_window_without_reservation() -> None:
    windows = windows_of([], LeaseData(bench="rig", holder="bert", until=at(3)), NOW)
    found = expected([run(1)], windows, NOW, NOW, lambda _: 60.0)
    assert (spans(found), found[1].waits_for) == ({1: (3, 4)}, None)


def test_two_windows_are_waited_for_one_after_the_other() -> None:
    windows = windows_of([reserved(0, 10), reserved(12, 20, "carl")], None, NOW)
    assert spans(expected([run(1)], windows, NOW, NOW, lambda _: 300.0)) == {1: (20, 25)}
    assert spans(expected([run(1)], windows, NOW, NOW, lambda _: 60.0)) == {1: (10, 11)}


@pytest.mark.parametrize(
    ("share", "seconds", "minutes"),
    [(None, 1200.0, 10.0), (0.9, 1200.0, 10.0), (0.5, None, 10.0), (0.01, None, None), (None, 60.0, 0.0)],
)
def test_the_end_of_a_run_under_way(
    share: float | None, seconds: float | None, minutes: float | None
) -> None:
    found = end_of(at(-10), share, seconds, NOW)
    assert found == (None if minutes is None else at(minutes))
    assert end_of(None, share, seconds, NOW) is None
