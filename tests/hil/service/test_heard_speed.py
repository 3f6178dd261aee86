"""A service that was started since hears how fast the motor of a stopped bench turns."""

from __future__ import annotations

import asyncio
import datetime
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from hil.api_schemas.api import LastSpeed, Me
from hil.app.worker.motor_speed import MOTOR_SPEED
from hil.execution.motor_speed import Heard
from hil.service import heard_speeds
from hil.service.api._benches import reset_bench
from hil.service.api._problems import RefusedError
from hil.service.live.live_hub import LiveHub, last_speed
from hil.service.queue import Queue
from tests.hil.cli.test_sim_bench import serving
from tests.hil.service.served import Served, served

pytestmark = pytest.mark.slow


def stopped(service: Served, bench: str) -> Any:
    """A bench after an emergency stop, as soon as something is known of its speed, at most a minute later."""
    service.post(f"/benches/{bench}/emergency-stop")
    for _ in range(600):
        found = service.get(f"/benches/{bench}")
        if found["last_speed"] or found["speed_unknown"]:
            break
        time.sleep(0.1)
    return found


def test_the_speed_of_a_stopped_bench_is_heard_without_a_run(tmp_path: Path) -> None:
    with serving(tmp_path) as (_, file), served(tmp_path / "data", "--bench", str(file)) as service:
        (bench,) = [one["name"] for one in service.get("/benches")]
        assert service.get(f"/benches/{bench}")["last_speed"] is None  # nothing is asked of a free bench
        found = stopped(service, bench)
        assert found["last_speed"]["turns"] is False
        assert abs(found["last_speed"]["speed_rad_s"]) < 0.5
        service.post(f"/benches/{bench}/reset")
        assert service.get(f"/benches/{bench}")["last_speed"] is None


def test_of_a_simulated_bench_it_says_why_not(tmp_path: Path) -> None:
    with served(tmp_path / "data", state=tmp_path / "state") as service:
        assert (
            stopped(service, "sim")["speed_unknown"] == "the bench is simulated, and exists during a run only"
        )


class _Hub(LiveHub):
    """As after a run whose last sample is of a motor that turns, or stands."""

    def __init__(self, folder: Path, speed_rad_s: float) -> None:
        super().__init__(lambda: ["axle"], lambda bench: None, folder)
        self._last = last_speed(speed_rad_s, datetime.datetime.now(datetime.UTC))

    def measured_speed(self, bench: str) -> LastSpeed | None:
        return self._last


def _looks(monkeypatch: pytest.MonkeyPatch, hub: LiveHub, heard: list[float]) -> LastSpeed | None:
    """The last speed of a stopped bench on whose buses these are heard."""

    async def hear(bench: Path) -> Heard:
        return Heard(heard.pop(0))

    monkeypatch.setattr(heard_speeds, "hear_motor_speed", hear)
    monkeypatch.setattr(heard_speeds, "_LOOK_S", 0.0)
    monkeypatch.setattr(heard_speeds, "_TURNING_S", 0.0)
    bench = SimpleNamespace(file=SimpleNamespace(source=Path("axle.toml")))
    service: Any = SimpleNamespace(
        benches=["axle"],
        live_hub=hub,
        own=lambda name: bench,
        running=lambda name: None,
        state=lambda name: ("emergency_stop", ""),
    )
    turns = iter([False] * 5)
    asyncio.run(heard_speeds.HeardSpeeds(service).work(lambda: next(turns, True)))
    return hub.last_speed("axle")


def test_a_motor_that_a_run_left_turning_is_heard_until_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    heard = [40.0, 0.1, 99.0]
    last = _looks(monkeypatch, _Hub(tmp_path, 137.0), heard)
    assert last is not None
    assert (last.speed_rad_s, last.turns) == (0.1, False)
    assert heard == [99.0]  # of an axle that stands no one asks any longer


def test_the_services_own_listener_is_no_other_program_on_the_bench() -> None:
    used = ""
    bench: Any = SimpleNamespace(name="axle", stopped=lambda: "", used_by=lambda: used)
    other: Any = SimpleNamespace(hold=lambda name: "", running=lambda service: [], service="me")
    queue = Queue({"axle": bench}, other, other, other, Path(), lambda name: Path(), lambda name: None)
    states = []
    for command in (" ".join(MOTOR_SPEED), "hil bench monitor axle.toml"):
        used = f"the bench is in use: process 7 ({command} axle.toml) holds can0"
        queue._places["axle"].looked_s = -1e9
        states.append(queue.state("axle"))
    assert states == [("free", ""), ("in_use", used)]


def test_a_motor_that_a_run_saw_stand_is_not_listened_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    last = _looks(monkeypatch, _Hub(tmp_path, 0.1), heard := [99.0])
    assert last is not None
    assert last.speed_rad_s == 0.1
    assert heard == [99.0]


@pytest.mark.parametrize(
    ("speed_rad_s", "ago_s", "refused"),
    [(42.1, 0.0, True), (-280.0, 6.0, True), (42.1, 60.0, False), (0.1, 0.0, False)],
)
def test_a_stop_is_not_reset_while_the_axle_is_seen_to_turn(
    tmp_path: Path, speed_rad_s: float, ago_s: float, refused: bool
) -> None:
    """What was seen a while ago says little of now: then a person has to look."""
    hub = _Hub(tmp_path, 0.1)
    at = datetime.datetime.now(datetime.UTC) - datetime.timedelta(seconds=ago_s)
    hub._last = last_speed(speed_rad_s, at)
    reset = []

    async def resetting(bench: str, by: str) -> int:
        reset.append(bench)
        return 1

    service: Any = SimpleNamespace(
        benches=["axle"],
        live_hub=hub,
        running=lambda name: None,
        reset=resetting,
        log=SimpleNamespace(add=lambda *row: None),
        wake=lambda name: None,
        changed=lambda name: None,
        bench_data=lambda name: None,
    )
    asked = reset_bench("axle", service, Me(name="anna", role="engineer", tokens=True))
    if refused:
        with pytest.raises(RefusedError, match=f"the motor had {abs(speed_rad_s)} rad/s"):
            asyncio.run(asked)
    else:
        asyncio.run(asked)
    assert reset == ([] if refused else ["axle"])
