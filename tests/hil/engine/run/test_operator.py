"""What the person at the bench types, as the loop takes it; time goes on while they are asked."""

from __future__ import annotations

import pytest

from drivers import BusLoop
from hil.core.errors import EmergencyStopError, InterruptError
from hil.engine.ipc.ipc_messages import EmergencyAsked
from hil.engine.run.operator import GONE, GONE_REASON, LOOK_S, Operator
from tests.clocks import SteppedClock
from tests.operators import Answering, Silent


def at(
    terminal: Silent | Answering | None, by: str = "", *, virtual: bool = False
) -> tuple[Operator, BusLoop]:
    loop = BusLoop(SteppedClock(virtual=virtual), [])
    operator = Operator(loop, terminal, by)
    if not virtual:
        loop.every(LOOK_S, operator.look)
    return operator, loop


@pytest.mark.parametrize(
    ("lines", "paused", "resumed", "stopped"),
    [
        (["p"], True, False, False),
        (["r"], False, True, False),
        (["q"], False, False, True),
        ([" P \n"], True, False, False),
        (["p", "r", "q"], True, True, True),
        (["", "pause", "qq", "E!"], False, False, False),
        ([], False, False, False),
    ],
)
def test_single_letters_are_orders(lines: list[str], paused: bool, resumed: bool, stopped: bool) -> None:
    terminal = Silent()
    operator, loop = at(terminal)
    terminal.waiting = [*lines]
    operator.look()
    assert (operator.take_pause(), operator.take_resume()) == (paused, resumed)
    assert (operator.take_pause(), operator.take_resume()) == (False, False)  # each counts once
    assert loop.stop_requested is stopped


@pytest.mark.parametrize("virtual", [False, True])
def test_a_run_whose_service_has_gone_was_not_stopped_by_the_operator(virtual: bool) -> None:
    terminal = Silent()
    operator, _ = at(terminal, virtual=virtual)
    terminal.waiting = [GONE]
    with pytest.raises(InterruptError) as caught:
        operator.wait_for(lambda: False, 1.0)
    assert caught.value.what == GONE_REASON


@pytest.mark.parametrize("line", ["e", "E", " e\n"])
def test_an_emergency_stop_is_raised_at_once(line: str) -> None:
    terminal = Silent()
    operator, _ = at(terminal)
    terminal.waiting = [line]
    with pytest.raises(EmergencyStopError) as caught:
        operator.look()
    assert (caught.value.by, caught.value.way) == ("the operator", "terminal")


def test_an_emergency_stop_of_another_way_says_who_from_where_and_how_and_counts_once() -> None:
    terminal = Silent()
    operator, _ = at(terminal)
    terminal.waiting = [EmergencyAsked(by="anna", origin="10.0.0.7", way="page")]
    with pytest.raises(EmergencyStopError, match="requested by anna from 10.0.0.7 on the") as found:
        operator.look()
    assert (found.value.by, found.value.origin, found.value.way) == ("anna", "10.0.0.7", "page")
    terminal.waiting = ["e"]
    operator.look()  # what makes the bench safe is not disturbed


@pytest.mark.parametrize("virtual", [False, True])
@pytest.mark.parametrize(
    ("answer", "said"), [("", ""), ("torque wrench 4711", "; remark: torque wrench 4711")]
)
def test_a_prompt_is_confirmed_by_any_line(answer: str, said: str, virtual: bool) -> None:
    operator, _ = at(Answering(answer), virtual=virtual)
    assert operator.confirm("inspect the shafts", 5.0) == f"confirmed by the operator{said}"


def test_what_was_typed_before_the_prompt_is_no_answer() -> None:
    terminal = Silent()
    operator, _ = at(terminal)
    terminal.waiting = [""]
    with pytest.raises(InterruptError, match="no answer to 'ready' within 0.3 s"):
        operator.confirm("ready", 0.3)


@pytest.mark.parametrize(("answer", "error"), [("q", InterruptError), ("e", EmergencyStopError)])
@pytest.mark.parametrize("virtual", [False, True])
@pytest.mark.parametrize("shielded", [False, True])
def test_who_is_asked_may_decline_also_in_end_steps(
    answer: str, error: type[Exception], virtual: bool, shielded: bool
) -> None:
    operator, loop = at(Answering(answer), virtual=virtual)
    loop.shielded = shielded
    with pytest.raises(error):
        operator.confirm("ready", 5.0)


def test_who_does_not_continue_is_the_reason_of_the_end() -> None:
    operator, _ = at(Answering("q"))
    with pytest.raises(InterruptError) as declined:
        operator.confirm("Is the cage shut?", 5.0)
    assert str(declined.value) == "stopped by the operator, who did not continue at 'Is the cage shut?'"


def test_a_pause_at_a_prompt_is_an_answer_and_holds_nothing_afterwards() -> None:
    operator, _ = at(Answering("p"))
    assert operator.confirm("ready", 5.0) == "confirmed by the operator; remark: p"
    assert not operator.take_pause()


def test_nobody_there() -> None:
    operator, loop = at(None)
    assert not operator.present
    operator.tell("anything")
    operator.look()
    assert operator.confirm("ready", 5.0) == "no operator: a simulated bench continues"
    assert at(None, "A. Tester")[0].confirm("ready", 5.0) == "confirmed in advance by A. Tester"
    began_s = loop.clock.now_s()
    operator.pass_time()
    assert 0.0 < loop.clock.now_s() - began_s < 0.002
    operator, loop = at(None, virtual=True)
    operator.pass_time()
    assert loop.clock.now_s() == pytest.approx(0.01)


def test_bench_time_goes_on_while_somebody_is_asked_but_virtual_time_stands_still() -> None:
    for virtual in (False, True):
        operator, loop = at(Silent(), virtual=virtual)
        began_s, asked = loop.clock.now_s(), 0

        def third_time() -> bool:
            nonlocal asked
            asked += 1
            return asked > 3

        assert operator.wait_for(third_time, 5.0)
        assert (loop.clock.now_s() > began_s) is not virtual


def test_waiting_ends_with_its_time() -> None:
    operator, loop = at(Silent())
    began_s = loop.clock.now_s()
    assert not operator.wait_for(lambda: False, 0.25)
    assert loop.clock.now_s() - began_s == pytest.approx(0.25, abs=0.003)
