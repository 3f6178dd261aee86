import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_backend.rcs._objects import PowerStates, State

SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP, RESET = 0x06, 0x07, 0x0F, 0x02, 0x80


def after(*words):
    power = PowerStates()
    for word in words:
        power.command(word)
    return power.state


@pytest.mark.parametrize(
    ("words", "state"),
    [
        ((), State.SWITCH_ON_DISABLED),
        ((SHUTDOWN,), State.READY_TO_SWITCH_ON),
        ((SHUTDOWN, SWITCH_ON), State.SWITCHED_ON),
        ((SHUTDOWN, SWITCH_ON, ENABLE), State.OPERATION_ENABLED),
        ((SHUTDOWN, SWITCH_ON, ENABLE, QUICK_STOP), State.QUICK_STOP_ACTIVE),
        ((SHUTDOWN, SWITCH_ON, ENABLE, 0), State.SWITCH_ON_DISABLED),
        ((ENABLE,), State.SWITCH_ON_DISABLED),
        ((SWITCH_ON,), State.SWITCH_ON_DISABLED),
    ],
)
def test_transitions_of_cia_402(words, state):
    assert after(*words) is state


def test_a_fault_needs_a_rising_edge_and_never_ends_enabled():
    power = PowerStates()
    for word in (SHUTDOWN, SWITCH_ON, ENABLE | RESET):
        power.command(word)
    power.fail()
    power.command(ENABLE | RESET)
    assert power.state is State.FAULT
    power.command(ENABLE)
    power.command(RESET)
    assert power.state is State.SWITCH_ON_DISABLED


@given(st.lists(st.integers(0, 0xFFFF), max_size=30))
def test_no_way_leads_to_torque_but_through_switched_on(words):
    power = PowerStates()
    for word in words:
        before = power.state
        power.command(word)
        if power.state is State.OPERATION_ENABLED:
            assert before in (State.SWITCHED_ON, State.OPERATION_ENABLED)


@given(st.lists(st.integers(0, 0xFFFF), max_size=30))
def test_the_statusword_names_the_state(words):
    power = PowerStates()
    for word in words:
        power.command(word)
    assert State(power.statusword & 0x6F) is power.state
