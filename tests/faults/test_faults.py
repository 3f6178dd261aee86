"""The matrix of faults: a few cells at each run of the tests, all of them when there is time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.faults.expected import FaultRow, row
from tests.faults.judging import wrong
from tests.faults.stage import PHASES, Injection
from tests.faults.table import FAULTS
from tests.faults.trying import Outcome, execute, prepared

CELLS = [(fault, phase) for fault in FAULTS for phase in fault.phases]
QUICK = {("rmcu-silent", "stepping"), ("dyno-fault", "holding speed"), ("sigterm", "stepping"),
         ("device-beat", "stepping"), ("disk-full", "stepping"), ("stamps-later", "stepping")}  # fmt: skip
AT_LEAST = 30
#: Of each fault one phase, another from fault to fault: the slow set. All: `make faults`, `make hunt`.
ONE_EACH = {(fault.id, fault.phases[index % len(fault.phases)]) for index, fault in enumerate(FAULTS)}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with prepared(tmp_path_factory.mktemp("faults")) as folder:
        yield folder


def named(cell: tuple[FaultRow, str]) -> str:
    return f"{cell[0].id} / {cell[1]}"


def _marks(cell: tuple[FaultRow, str]) -> list[pytest.MarkDecorator]:
    place = cell[0].id, cell[1]
    if place in QUICK:
        return []
    return [pytest.mark.slow if place in ONE_EACH else pytest.mark.hunt]


@pytest.mark.parametrize(
    "cell",
    [pytest.param(cell, id=named(cell), marks=_marks(cell)) for cell in CELLS],
)
def test_a_cell(cell: tuple[FaultRow, str], place: Path) -> None:
    fault, phase = cell
    folder = place / named(cell).replace(" ", "-").replace("/", "in")
    outcome = execute(fault, phase, folder)
    assert wrong(fault, phase, outcome, folder) == [], outcome.said


def test_the_table_is_whole() -> None:
    names = [fault.id for fault in FAULTS]
    assert len(set(names)) == len(names) >= AT_LEAST
    assert all(set(fault.phases) <= set(PHASES) for fault in FAULTS)
    assert {phase for _, phase in CELLS} == set(PHASES)
    assert {(fault.id, phase) for fault, phase in CELLS} >= QUICK


@pytest.mark.slow
def test_a_fault_that_is_not_injected_is_wrong(place: Path) -> None:
    nothing = row("nothing", "nothing", Injection)
    outcome = execute(nothing, "stepping", place / "nothing")
    assert outcome.injected_s is not None
    assert wrong(nothing, "stepping", outcome, place / "nothing") == ["the fault was not injected"]


WELL = Outcome(
    3, "error: lost", 1, 2.0, 3.0, 1.0, 2.1, armed=True, largest_nm=9.0, result={"safe_state": "confirmed"}
)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"code": None}, "hung or died"),
        ({"code": 0}, "exit code 0, 3 is right"),
        ({"counted": 0}, "was not injected"),
        ({"injected_s": None}, "was not injected"),
        ({"said": "error: found"}, "does not say 'lost'"),
        ({"said": "lost Traceback"}, "a traceback"),
        ({"last_torque_s": 2.2}, "torque for 200 ms, 150 ms are right"),
        ({"last_torque_s": 3.2}, "torque is still on after the end"),
        ({"result": {"safe_state": "not_confirmed"}}, "safe state not_confirmed"),
        ({"result": {"safe_state": "not_needed"}}, "safe state not_needed"),  # it was armed
        ({"result": None}, "no result.json"),
        ({}, "no recording"),
    ],
)
def test_what_is_wrong_is_seen(changes: dict[str, object], said: str, tmp_path: Path) -> None:
    fault = row("f", "f", Injection, "lost")
    found = wrong(fault, "stepping", replace(WELL, **changes), tmp_path)  # type: ignore[arg-type]
    assert said in "; ".join(found)
