"""Which tests are quick, which slow ones gate a change, and which run at night: decided by measured seconds.

`tests/durations.json` has the seconds of every test that takes long (tests/durations.py measures them). A
test that takes longer than `QUICK_S`, or whose module prepares something for longer, is slow, marked or not.
Of the slow ones of a module those gate that fit into `MODULE_S`, the shortest first: one module proves
things of one kind, and the shortest prove most in a second. What has to gate although it is longer stands in
`PINNED`. All others, and those that were never measured, run by `make nightly` (tests/nightly.py).
"""

from __future__ import annotations

import functools
import json
from collections.abc import Iterable, Mapping
from pathlib import Path

DURATIONS = Path(__file__).with_name("durations.json")
QUICK_S = 0.75
MODULE_S = 4.0

#: Long, and part of the gate all the same: a module below tests/, a part of the test's name, what it proves.
PINNED = {
    "can_vm/test_the_machine.py::controllers": "runs over real SocketCAN, beside the CAN tools of others",
    "test_wheel.py::empty_folder": "the wheel installs and runs",
    "hil/cli/test_run_to_the_end.py::same_out_twice": "results, overwriting, pipes of whole runs",
    "hil/cli/test_commands.py::ctrl_c": "Ctrl-C leaves a safe bench and the data",
    "hil/cli/test_kills.py::run_that_is_killed": "a run that is killed leaves no torque",
    "hil/cli/test_kills.py::process_makes_safe[9]": "a command that is gone leaves a safe bench",
    "hil/cli/test_identify_and_design.py::identify_writes": "from a recording to a model",
    "hil/cli/test_full_disk.py::fills_up": "a full disk costs no evidence and leaves a safe bench",
    "hil/engine/run/test_wall_clock.py::compiled_or_loaded": "a bench in real time waits for no compiler",
    "hil/service/frontend/test_app.py::test_a_plan_is_foreseen": "a run by the page, from forecast to report",
    "hil/service/test_serve.py::killed_service": "a killed service loses nothing and runs nothing twice",
    "hil/service/test_stop_under_attack.py::torque_goes[half_open]": "a stop is answered under attack",
    "hil/service/test_access.py::each_role": "who may do what, over every route of the API",
    "hil/service/test_client.py::exit_code": "a run over the API is one at the terminal",
    "hil/test_base_install.py::runs_a_plan": "a base install runs plans and writes reports",
    "hil/analysis/diagnosis/test_diagnose.py::two_effects": "missing effects are named",
}


def pinned(nodeid: str) -> bool:
    """Whether a test gates however long it takes; `nodeid` is pytest's, from the repository's root."""
    module, _, name = nodeid.removeprefix("tests/").partition("::")
    return any(module == place.partition("::")[0] and place.partition("::")[2] in name for place in PINNED)


@functools.cache
def measured() -> Mapping[str, float]:
    """Seconds by test, and of what a module prepares by its path; nothing of what is quick."""
    found: dict[str, float] = json.loads(DURATIONS.read_text("utf-8"))
    return found


def is_long(nodeid: str, *, prepared: bool) -> bool:
    """Whether a test is slow by its own seconds or, if it uses what its module has `prepared`, by those."""
    module = nodeid.partition("::")[0]
    seconds = max(measured().get(nodeid, 0.0), measured().get(module, 0.0) if prepared else 0.0)
    return seconds > QUICK_S


def gating(slow: Iterable[str]) -> set[str]:
    """Those of the slow tests that gate."""
    modules: dict[str, list[str]] = {}
    for nodeid in slow:
        modules.setdefault(nodeid.partition("::")[0], []).append(nodeid)
    return {nodeid for tests in modules.values() for nodeid in _within(tests)}


def _within(tests: list[str]) -> list[str]:
    """Those of one module: what is pinned, then the shortest that still fit."""
    seconds = measured()
    module = tests[0].partition("::")[0]
    chosen = [nodeid for nodeid in tests if pinned(nodeid)]
    left = MODULE_S - sum(seconds.get(nodeid, 0.0) for nodeid in chosen) - seconds.get(module, 0.0)
    known = (nodeid for nodeid in tests if nodeid in seconds and nodeid not in chosen)
    for nodeid in sorted(known, key=lambda one: seconds[one]):
        left -= seconds[nodeid]
        if left < 0.0:
            break
        chosen.append(nodeid)
    return chosen
