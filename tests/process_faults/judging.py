"""What is wrong with a cell, in words; nothing is an empty list."""

from __future__ import annotations

import re
import signal

from tests.process_faults.trying import LOST_S, Fault, Outcome

TORQUE_S = 0.1
#: `hung_after_s` and `alone_after_s` of a bench file that does not name them, s.
NOTICED_S = 2.0
_SAYS: dict[tuple[str, int], str] = {
    ("holder", signal.SIGKILL): "was ended by SIGKILL",
    ("holder", signal.SIGSTOP): "was not running|was stopped",
    ("command", signal.SIGKILL): "the command of this run has ended",
    ("command", signal.SIGSTOP): "the command has been silent",
    ("bench", signal.SIGKILL): "error: ",
    ("bench", signal.SIGSTOP): "error: ",
}
_BEFORE = ("opening", "arming")


def wrong(fault: Fault, phase: str, outcome: Outcome) -> list[str]:
    """Every demand that the cell does not meet."""
    killed = fault.whom == "command" and fault.number == signal.SIGKILL
    found = [f"{name} is still running" for name in outcome.left]
    if outcome.code != (-signal.SIGKILL if killed else 3):
        found.append(f"exit code {outcome.code}")
    says = _SAYS[fault.whom, fault.number]
    if phase != "writing" and not re.search(says, " ".join(outcome.said.split())):
        found.append(f"does not say '{says}'")
    if "Traceback" in outcome.said:
        found.append("a traceback")
    if outcome.missing_s > LOST_S:
        found.append(f"{outcome.missing_s:.2f} s are missing")
    return found + _of_torque(fault, outcome) + _of_safe_state(fault, phase, outcome)


def _of_torque(fault: Fault, outcome: Outcome) -> list[str]:
    """NaN: there was none."""
    if fault.whom == "holder":
        return [f"torque for {outcome.stale_s:.3f} s"] if outcome.stale_s > TORQUE_S else []
    most_s = TORQUE_S + (NOTICED_S if fault.number == signal.SIGSTOP else 0.0)
    return [f"torque for {outcome.torque_s:.3f} s"] if outcome.torque_s > most_s else []


def _of_safe_state(fault: Fault, phase: str, outcome: Outcome) -> list[str]:
    if outcome.result is None:
        return [] if phase in _BEFORE else ["no result"]
    right = {"not_confirmed"} if fault.whom == "bench" else {"confirmed"}
    right |= {"not_needed", "not_confirmed"} if phase in _BEFORE else set()
    state = outcome.result.safe_state
    return [] if state in right else [f"safe state {state}"]
