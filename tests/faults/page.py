"""docs/reference/faults.md, from the cells."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tests.faults.expected import FaultRow
from tests.faults.stage import PHASES
from tests.faults.trying import Outcome

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "faults.md"
_SAFE = {"confirmed": "safe", "not_confirmed": "not confirmed", "not_needed": "not armed", "": "no result"}
_INTRODUCTION = """\
# Faults

Made by `make faults` (`python -m tests.faults --write`): `hil run` on the simulated bench, tick by tick,
with one fault injected in one phase. Each cell is a process of its own; how often the fault really
changed something is counted, and a cell in which it did not is wrong. Torque is read from the plant's
own log.

A cell says: exit code · for how long the RMCU went on asking the inverter for torque, ms (of bench time,
where torque was on or came later) · what the run says of the safe state. *Not confirmed* is right where
the device that should confirm it cannot be heard: then the run says so, and the device's own time-out
(50 ms without a request, 200 ms without the host's heartbeat) is what takes the torque away. An empty
cell: the fault does not exist there. Every cell also has to name its cause, to leave a recording that is
readable up to the fault (after `hil evidence recover` if need be), and no traceback.
"""
_GOES_ON = """\
What ends no run: single frames lost, doubled, swapped or late; garbage among the frames; a pause of the
loop before anything is armed. *Torque does not follow* is noticed where the bench file limits
`motor_torque_error_nm` (docs/reference/limits.md), or where a criterion of the plan sees it. A value
that is stuck is noticed within 60 ms of torque, before that when it is to change. A panel that is busy,
or answers all with errors, is heard: it ends a run where something is asked of it, in pre-flight or by a
step `set_vehicle`.
"""

Cell = tuple[FaultRow, str, Outcome, list[str]]


def page_of(cells: Sequence[Cell]) -> str:
    """The whole page."""
    rows: dict[str, dict[str, str]] = {}
    titles: dict[str, str] = {}
    for fault, phase, outcome, wrong in cells:
        titles[fault.id] = fault.title
        rows.setdefault(fault.id, {})[phase] = _cell(outcome, wrong)
    wrong_cells = sum(bool(wrong) for *_, wrong in cells)
    counted = sum(outcome.counted for _, _, outcome, _ in cells)
    head = f"{len(rows)} faults, {len(cells)} cells, {wrong_cells} wrong; {counted} injections counted.\n"
    table = "| fault | " + " | ".join(PHASES) + " |\n|---|" + "---|" * len(PHASES) + "\n"
    for name, found in rows.items():
        table += f"| {titles[name]} | " + " | ".join(found.get(phase, "") for phase in PHASES) + " |\n"
    return "\n".join([_INTRODUCTION, head, table, _GOES_ON])


def _cell(outcome: Outcome, wrong: list[str]) -> str:
    state = str((outcome.result or {}).get("safe_state", ""))
    torque = outcome.torque_s if outcome.code else None
    parts = [str(outcome.code), *([f"{1e3 * torque:.0f}"] if torque is not None else []), _SAFE[state]]
    said = " · ".join(parts)
    return f"**{said}: {'; '.join(wrong)}**" if wrong else said
