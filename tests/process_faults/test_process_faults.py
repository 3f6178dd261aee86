"""The faults of processes: one cell at each run of the slow tests, all with `make process-faults`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.core.result import RunResult
from tests.process_faults.__main__ import page_of
from tests.process_faults.judging import wrong
from tests.process_faults.trying import FAULTS, PHASES, Outcome, execute, packages

MOST_REPEATS = 4
KILLED, FROZEN, COMMAND_KILLED, COMMAND_FROZEN, BENCH_KILLED, _ = FAULTS
SAFE = RunResult(
    verdict="error", plan="p", bench="b", real_time_factor=1, bench_time_s=1, safe_state="confirmed"
)
WELL = Outcome(3, "error: it was ended by SIGKILL", SAFE, 0.06, 0.05, 0.2, ())


@pytest.mark.slow
def test_an_analysis_in_the_middle_of_a_run_whose_process_is_killed(tmp_path: Path) -> None:
    """At the terminal, with a bench in a third process; what steps is in tests/hil/cli/test_kills.py."""
    with packages(tmp_path):
        for attempt in range(MOST_REPEATS):
            outcome = execute(KILLED, "analysing", tmp_path / str(attempt))
            if outcome is not None:
                break
    assert outcome is not None
    assert wrong(KILLED, "analysing", outcome) == [], outcome.said


def test_the_table_is_whole() -> None:
    assert len({fault.title for fault in FAULTS}) == len(FAULTS)
    assert {phase for fault in FAULTS for phase in fault.phases} == set(PHASES)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"code": 0}, "exit code 0"),
        ({"said": "error: something"}, "does not say"),
        ({"said": "was ended by SIGKILL Traceback"}, "a traceback"),
        ({"stale_s": 0.11}, "torque for 0.110 s"),
        ({"stale_s": np.inf}, "torque for inf s"),
        ({"missing_s": 0.6}, "0.60 s are missing"),
        ({"left": ("holder",)}, "holder is still running"),
        ({"result": None}, "no result"),
        ({"result": SAFE.model_copy(update={"safe_state": "not_needed"})}, "safe state not_needed"),
    ],
)
def test_what_is_wrong_is_seen(changes: dict[str, object], said: str) -> None:
    assert wrong(KILLED, "stepping", WELL) == []
    outcome = replace(WELL, **changes)  # type: ignore[arg-type]
    assert said in "; ".join(wrong(KILLED, "stepping", outcome))
    assert "1 wrong" in page_of([(KILLED, "stepping", outcome, ["x"])], 0)


def test_a_frozen_command_may_take_until_it_is_noticed_and_a_killed_one_may_not() -> None:
    late = replace(WELL, said="the command has been silent for 2.0 s", torque_s=2.05)
    assert wrong(COMMAND_FROZEN, "stepping", late) == []
    late = replace(WELL, said="the command of this run has ended", torque_s=2.05, code=-9)
    assert wrong(COMMAND_KILLED, "stepping", late) == ["torque for 2.050 s"]


def test_of_a_bench_that_is_gone_nothing_is_confirmed() -> None:
    assert wrong(BENCH_KILLED, "stepping", WELL) == ["safe state confirmed"]
