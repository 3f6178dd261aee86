"""The CiA 402 state machine (IEC 61800-7-201, FSA of the drive), without its transitional states."""

from __future__ import annotations

from enum import Enum


class State(Enum):
    """States with their statusword bits (6, 5, 3, 2, 1, 0)."""

    SWITCH_ON_DISABLED = 0x40
    READY_TO_SWITCH_ON = 0x21
    SWITCHED_ON = 0x23
    OPERATION_ENABLED = 0x27
    QUICK_STOP_ACTIVE = 0x07
    FAULT = 0x08


_FAULT_RESET = 0x80


class PowerStates:
    """Follows the controlword; `state` decides whether the drive gives torque."""

    def __init__(self) -> None:
        self.state = State.SWITCH_ON_DISABLED
        self._last = 0

    @property
    def statusword(self) -> int:
        """Statusword with voltage enabled (bit 4)."""
        return self.state.value | 0x10

    def command(self, controlword: int) -> None:
        """Apply one controlword; fault reset counts on its rising edge only."""
        rising = controlword & ~self._last
        self._last = controlword
        if self.state is State.FAULT:
            if rising & _FAULT_RESET:
                self.state = State.SWITCH_ON_DISABLED
            return
        self.state = self._next(controlword)

    def fail(self) -> None:
        """Enter FAULT: torque off until reset."""
        self.state = State.FAULT

    def _next(self, word: int) -> State:
        if not word & 0x02:  # disable voltage
            return State.SWITCH_ON_DISABLED
        if not word & 0x04:  # quick stop
            enabled = self.state in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
            return State.QUICK_STOP_ACTIVE if enabled else State.SWITCH_ON_DISABLED
        if not word & 0x01:  # shutdown
            return State.READY_TO_SWITCH_ON
        on = self.state is not State.SWITCH_ON_DISABLED
        if not on:
            return self.state  # a drive that has not been readied does not switch on
        if not word & 0x08:
            return State.SWITCHED_ON
        ready = self.state in (State.SWITCHED_ON, State.OPERATION_ENABLED)
        return State.OPERATION_ENABLED if ready else State.SWITCHED_ON
