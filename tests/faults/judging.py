"""What is wrong with a cell, in words; nothing is an empty list."""

from __future__ import annotations

import re
from pathlib import Path

from hil.core.errors import HilError
from hil.core.recording import read_recording, recover_recording
from tests.faults.expected import BENCH, FaultRow
from tests.faults.trying import Outcome

LOST_S = 0.5
DEVICES_WAIT_S = 0.06  # an RMCU without requests gives no torque after 50 ms
_BEFORE_ROWS_S = 0.7  # rows begin when every device is up, and reach the disk within 0.25 s


def wrong(fault: FaultRow, phase: str, outcome: Outcome, folder: Path) -> list[str]:
    """Every demand that the cell does not meet."""
    if outcome.code is None:
        return [f"it hung or died: {outcome.said[-300:]}"]
    if outcome.injected_s is None or not outcome.counted:
        return ["the fault was not injected"]
    expected = fault.expects(phase)
    found = []
    if outcome.code != expected.code:
        found.append(f"exit code {outcome.code}, {expected.code} is right")
    if not re.search(expected.says, outcome.said):
        found.append(f"the message does not say '{expected.says}'")
    if "Traceback" in outcome.said:
        found.append("a traceback")
    found += _of_torque(fault.within_s if expected.code else None, outcome)
    found += _of_safe_state(fault, phase, outcome)
    found += _of_data(outcome, folder)
    return found


def _of_torque(within_s: float | None, outcome: Outcome) -> list[str]:
    if outcome.last_torque_s > outcome.ended_s + DEVICES_WAIT_S:
        return ["torque is still on after the end"]
    if within_s is not None and outcome.torque_s is not None and outcome.torque_s > within_s:
        return [f"torque for {1e3 * outcome.torque_s:.0f} ms, {1e3 * within_s:.0f} ms are right"]
    return []


def _of_safe_state(fault: FaultRow, phase: str, outcome: Outcome) -> list[str]:
    allowed = fault.expects(phase).safe
    if outcome.result is None:
        return [] if "not_needed" in allowed else ["no result.json"]
    state = outcome.result["safe_state"]
    if state == "not_needed" and not outcome.armed:
        return []
    return [] if state in allowed else [f"safe state {state}, right is {' or '.join(allowed)}"]


def _of_data(outcome: Outcome, folder: Path) -> list[str]:
    """All that was measured up to the fault can be read, after `recover` if it has to be."""
    path = folder / "out" / "recording.mcap"
    assert outcome.injected_s is not None
    if not path.is_file():
        return [] if outcome.injected_s < _BEFORE_ROWS_S or outcome.code != BENCH else ["no recording"]
    try:
        recording = read_recording(path, least_samples=0, allow_missing=True)
        if recording.damage:
            recording = recover_recording(path, folder / "recovered.mcap")
    except HilError as error:
        early = outcome.injected_s < _BEFORE_ROWS_S
        return [] if early else [f"the recording cannot be read: {error}"]
    if not len(recording.time_s):
        return [] if outcome.injected_s < _BEFORE_ROWS_S else ["the recording has no rows"]
    row_0_s = float(recording.metadata.get("time", {}).get("bench_clock_at_row_0_s", 0.7))
    missing_s = outcome.injected_s - (row_0_s + float(recording.time_s[-1]))
    return [f"the last {missing_s:.2f} s before the fault are missing"] if missing_s > LOST_S else []
