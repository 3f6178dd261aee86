"""How long a run is held, by whom, and what ends it: the rules alone, without a bench."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from drivers import BusLoop
from hil.core.errors import EmergencyStopError, InterruptError, OrderlyEndError
from hil.engine.bench.ranges import Range
from hil.engine.run.hold import LONGEST_PAUSE_S, MOST_HOLDS, Holding
from hil.engine.run.operator import LOOK_S, Operator
from tests.clocks import SteppedClock
from tests.operators import Silent

CAGE = Range("cage", 0.5, 9.0, 0.0, "cage", response="hold", message="shut it", well_for_s=0.5, timeout_s=3.0)
HEAT = Range("oil", 0.0, 350.0, 0.0, "heat", response="pause")


class Floor:
    """A held run: what stands by the time (s) since it began, and what the operator types when."""

    def __init__(
        self,
        stands: Callable[[float], list[Range]],
        typed: dict[float, str] | None = None,
        *,
        alone: bool = False,
        oversleeps_s: float = 0.0,
    ) -> None:
        self.clock = SteppedClock(virtual=False, oversleeps_s=oversleeps_s)
        self.loop = BusLoop(self.clock, [])
        self.terminal = Silent()
        self.operator = Operator(self.loop, None if alone else self.terminal, "")
        self.events: list[tuple[str, str]] = []
        self._stands, self._typed, self._began_s = stands, dict(typed or {}), self.clock.now_s()
        self.hold = Holding(self.loop, self.operator, self._standing, self._event, lambda now_s: now_s)
        self.loop.every(LOOK_S, self._look)

    def _passed_s(self) -> float:
        return self.clock.now_s() - self._began_s

    def _standing(self) -> list[tuple[Range, str]]:
        return [(range_, f"{range_.channel} is wrong") for range_ in self._stands(self._passed_s())]

    def _event(self, kind: str, text: str) -> None:
        self.events.append((kind, text))

    def _look(self) -> None:
        for when_s in [when_s for when_s in self._typed if when_s <= self._passed_s()]:
            self.terminal.waiting.append(self._typed.pop(when_s))
        if self.operator.present:
            self.operator.look()

    def held_s(self, *causes: Range) -> float:
        for cause in causes:
            self.hold.ask(cause, f"{cause.channel} is wrong")
        assert self.hold.due()
        self.hold.wait()
        assert not self.hold.due()
        (held,) = self.hold.holds
        return held.end_s - held.start_s


def until(end_s: float, *ranges: Range) -> Callable[[float], list[Range]]:
    return lambda passed_s: list(ranges) if passed_s < end_s else []


@pytest.mark.parametrize(
    ("causes", "stands", "typed", "held_s", "ended_by"),
    [
        ([CAGE], until(1.0, CAGE), {}, 1.5, "well again"),  # a second open, half a second well
        ([CAGE], until(0.0), {}, 0.5, "well again"),
        # opens again while it counts as well: counting begins anew
        ([CAGE], lambda s: [CAGE] if s < 1.0 or 1.3 <= s < 1.4 else [], {}, 1.9, "well again"),
        ([CAGE], until(1.0, CAGE), {0.2: "r"}, 1.5, "well again"),  # no one can wave an interlock through
        ([HEAT], until(1.0, HEAT), {2.0: "r"}, 2.0, "operator"),
        ([HEAT], until(1.0, HEAT), {0.5: "r", 2.5: "r"}, 2.5, "operator"),  # too early is not kept
        ([HEAT, CAGE], until(2.0, CAGE), {1.0: "r"}, 2.5, "well again"),  # both must be over
        ([HEAT, CAGE], until(1.0, CAGE), {2.5: "r"}, 2.5, "operator"),
    ],
)  # fmt: skip
def test_it_goes_on_when_every_cause_is_over(
    causes: list[Range],
    stands: Callable[[float], list[Range]],
    typed: dict[float, str],
    held_s: float,
    ended_by: str,
) -> None:
    floor = Floor(stands, typed)
    assert floor.held_s(*causes) == pytest.approx(held_s, abs=LOOK_S + 0.005)
    assert floor.hold.holds[0].ended_by == ended_by
    assert floor.hold.causes_shown == ""
    (started, over) = floor.events
    assert started[1].startswith("held, torque off, the dynos hold their speed: ")
    assert over[1].endswith(ended_by)


@pytest.mark.parametrize(
    ("cause", "alone", "typed", "after_s", "error", "said"),
    [
        (CAGE, True, {}, 3.0, OrderlyEndError, "held for 3 s"),
        (HEAT, True, {}, 0.0, OrderlyEndError, "no terminal"),
        (HEAT, False, {1.0: "q"}, 1.0, InterruptError, "stopped by the operator"),
        (CAGE, False, {1.0: "e"}, 1.0, EmergencyStopError, "typed e"),
    ],
)
def test_what_ends_the_run(
    cause: Range, alone: bool, typed: dict[float, str], after_s: float, error: type[Exception], said: str
) -> None:
    floor = Floor(until(1e9, cause), typed, alone=alone)
    with pytest.raises(error, match=said):
        floor.held_s(cause)
    (held,) = floor.hold.holds
    assert held.end_s - held.start_s == pytest.approx(after_s, abs=LOOK_S + 0.005)
    assert (held.ended_by, held.cause) == ("end of the run", f"{cause.channel} is wrong")


def test_who_stops_a_run_ends_its_hold_though_one_cause_was_over_before() -> None:
    floor = Floor(until(1e9, CAGE), {0.5: "r", 1.0: "q"})
    with pytest.raises(InterruptError):
        floor.held_s(HEAT, CAGE)
    assert [hold.ended_by for hold in floor.hold.holds] == ["end of the run"]


def test_a_pause_that_nobody_ends_is_ended_after_ten_minutes() -> None:
    floor = Floor(until(1e9, HEAT), oversleeps_s=0.5)
    with pytest.raises(OrderlyEndError, match="held for 600 s"):
        floor.held_s(HEAT)
    (held,) = floor.hold.holds
    assert held.end_s - held.start_s == pytest.approx(LONGEST_PAUSE_S, abs=1.0)


def test_who_is_held_reads_why_and_what_to_do() -> None:
    floor = Floor(until(0.1, CAGE))
    floor.held_s(CAGE)
    assert floor.terminal.told == ["held: cage is wrong\nshut it\nresumes by itself when the cause is gone"]
    floor = Floor(until(0.4, HEAT), {0.2: "r", 0.6: "r"})
    floor.held_s(HEAT)
    asked, refused = floor.terminal.told
    assert asked.endswith("r and Enter: resume; q and Enter: end the run")
    assert refused == "not yet: oil is wrong"


def test_the_operator_pauses_and_lets_it_go_on() -> None:
    floor = Floor(until(0.0), {0.1: "p", 0.5: "r"})
    assert not floor.hold.due()
    floor.loop.run_for(0.2)
    assert floor.hold.due()
    floor.hold.wait()
    assert floor.hold.holds[0].cause == "paused by the operator"
    assert floor.hold.holds[0].ended_by == "operator"


def test_end_steps_are_not_held() -> None:
    floor = Floor(until(1e9, CAGE))
    floor.hold.ask(CAGE, "open")
    floor.hold.active = False
    assert not floor.hold.due()


def test_what_holds_a_run_for_the_sixth_time_ends_it() -> None:
    floor = Floor(until(0.0))
    for _ in range(MOST_HOLDS):
        floor.hold.ask(CAGE, "open")
        floor.hold.wait()
    floor.hold.refuse_end()
    floor.hold.ask(HEAT, "hot")  # counted by its own name
    floor.hold.ask(CAGE, "open")
    with pytest.raises(OrderlyEndError, match="it has already held the run 5 times"):
        floor.hold.refuse_end()


def test_the_first_reason_to_end_it_is_told() -> None:
    floor = Floor(until(0.0))
    floor.hold.end_run("too hot")
    floor.hold.end_run("too fast")
    assert floor.hold.due()
    with pytest.raises(OrderlyEndError, match="too hot"):
        floor.hold.wait()
    assert floor.hold.holds == []  # nothing held it
