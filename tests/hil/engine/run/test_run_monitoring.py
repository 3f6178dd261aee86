"""Who is told of a sample, and what is done about what a device, a limit or an interlock says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hil.core.errors import BenchError, EmergencyStopError, HilError, OrderlyEndError
from hil.engine.bench.ranges import NamedLimit
from sim_backend.bench import Fault
from sim_backend.can_interface import attached
from tests.benches_for_tests import SIM
from tests.hil.engine.cages import CHANNEL, cage, shut
from tests.hil.engine.run.test_arming import Stage, stage
from tests.operators import Silent

OPENS_S = 1.5  # the bench is armed before


def opening(now_s: float) -> float:
    return float(now_s < OPENS_S)


def limited(response: str) -> dict[str, Any]:
    named = NamedLimit.model_validate(
        {"channel": CHANNEL, "unit": "1", "below": 0.5, "persistence_samples": 0, "response": response}
    )
    return {"limits": SIM.limits.model_copy(update={"watch": {"opened": named}})}


def watched(at: Stage, for_s: float = 1.5) -> HilError | None:
    """Arm, then watch; what it raised."""
    at.arming.come_up()
    assert at.bench.loop.clock.now_s() < OPENS_S
    at.watch.begin()
    try:
        at.bench.loop.run_for(for_s)
    except HilError as error:
        return error
    return None


@pytest.mark.parametrize(
    ("changes", "error", "due", "words"),
    [
        (limited("trip"), BenchError, False, "limit tripped: cage_shut"),
        (limited("warn"), None, False, "response: warn"),
        (limited("pause"), None, True, "response: pause"),
        (limited("ramp_down"), None, True, "response: ramp_down"),
        ({"interlocks": shut()}, None, True, "response: hold"),
        ({"interlocks": shut(response="emergency_stop")}, EmergencyStopError, False, "shut the cage"),
    ],
)
def test_each_response(
    changes: dict[str, Any], error: type[HilError] | None, due: bool, words: str, tmp_path: Path
) -> None:
    with stage(tmp_path, "responses", devices=cage(opening), **changes) as at:
        raised = watched(at)
        assert (raised is None) if error is None else isinstance(raised, error)
        told = [event.text for event in at.recorder.events if event.kind == "limit"]
        assert len(told) == (0 if error is BenchError else 1)  # once, and who ended the run tells of a trip
        assert words in (str(raised) if raised else told[0])
        assert at.watch.hold.due() is due


def test_ramp_down_is_an_orderly_end(tmp_path: Path) -> None:
    with stage(tmp_path, "orderly", devices=cage(opening), **limited("ramp_down")) as at:
        assert watched(at) is None
        with pytest.raises(OrderlyEndError, match="cage_shut"):
            at.watch.hold.refuse_end()


def test_who_is_on_the_way_to_safety_is_not_disturbed(tmp_path: Path) -> None:
    with stage(
        tmp_path, "going", devices=cage(lambda s: 1.0 if s < OPENS_S else -1.0), **limited("trip")
    ) as at:
        at.arming.come_up()
        at.watch.begin()
        at.watch.end()
        at.bench.loop.run_for(1.5)
        assert at.watch.limits.results[-1].lowest == -1.0  # looked at all the same


@pytest.mark.parametrize(
    ("break_it", "said", "kind"),
    [
        (lambda at: attached(at.bench.file.name).fail(Fault.RMCU_SILENT), "has stopped coming", BenchError),
        (
            lambda at: attached(at.bench.file.name).fail(Fault.DYNO_SILENT),
            "wheel_speed_left_rad_s",
            BenchError,
        ),
    ],
)
def test_a_device_that_falls_silent_ends_it(
    break_it: Callable[[Stage], None], said: str, kind: type[HilError], tmp_path: Path
) -> None:
    with stage(tmp_path, "silent", devices=cage(lambda s: 1.0)) as at:
        assert watched(at, 0.1) is None
        break_it(at)
        with pytest.raises(kind, match=said):
            at.bench.loop.run_for(1.0)


def test_a_device_says_emergency(tmp_path: Path) -> None:
    with stage(tmp_path, "button", devices=cage(lambda s: 1.0 if s < OPENS_S else -1.0)) as at:
        raised = watched(at)
        assert isinstance(raised, EmergencyStopError)
        assert (raised.by, raised.what) == ("cage", "the button was pressed")


def test_the_operator_says_emergency(tmp_path: Path) -> None:
    operator = Silent()
    operator.waiting = ["e"]
    with stage(tmp_path, "typed", operator) as at:
        raised = watched(at, 0.1)
        assert isinstance(raised, EmergencyStopError)
        assert raised.by == "the operator"


def test_every_sample_is_recorded_until_the_rows_are_finished(tmp_path: Path) -> None:
    with stage(tmp_path, "rows") as at:
        assert watched(at, 0.5) is None
        whole = at.recorder.finish_rows()
        at.watch.rows_finished = True
        at.bench.loop.run_for(0.5)
        assert len(at.recorder.finish_rows().time_s) == len(whole.time_s)
        assert at.watch.limits.largest["motor_speed_rad_s"] >= 0.0
