"""An emergency stop is answered, and the motor's torque is off, whatever keeps the service busy meanwhile.

On a bench in a process of its own, in real time slowed down; the torque is what an observer on its bus sees.
"""

from __future__ import annotations

import contextlib
import json
import re
import subprocess
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from hil.client import Client
from tests.hil.cli.test_kills import Observer
from tests.hil.cli.test_sim_bench import serving
from tests.hil.service import attacks
from tests.hil.service.served import HIL, RefusedError, Served, environment_of, served

#: Without a way of its own a stop was answered after 10 s (locked database), 20 s (half-open connections),
#: 25 s (hostile model), or never (no descriptors): each attack goes on for longer than this.
WITHIN_S = 6.0
PLAN = """
name: attacked
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 2, duration_s: 0.1}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 100, before_s: 0.2, after_s: 60}
finally: [{ramp_down: {duration_s: 0.1}}]
"""
ON_NM = 5.0


@dataclass
class Bench:
    """A service with a bench of which the torque can be seen."""

    service: Served
    client: Client
    stop_url: str
    observer: Observer

    def run_with_torque_on(self) -> int:
        run = self.service.queue("attacked", "bench")
        until_s = time.monotonic() + 120
        while self.observer.torque() < ON_NM:
            assert time.monotonic() < until_s, self.service.get(f"/runs/{run}")
            time.sleep(0.05)
        return run

    def over(self, run: int) -> Any:
        """The run as it ended; a database that was locked is away for a second more."""
        for _ in range(20):
            with contextlib.suppress(RefusedError):
                return self.service.over(run)
            time.sleep(0.5)
        raise AssertionError("the service does not come back")

    def stop(self) -> None:
        """Stop it as `hil --server` does, and see the torque go."""
        began_s = time.monotonic()
        self.client.stop_in_emergency("bench")
        answered_s = time.monotonic() - began_s
        while self.observer.torque() != 0.0 and time.monotonic() - began_s < WITHIN_S:
            time.sleep(0.01)
        assert self.observer.torque() == 0.0, f"answered after {answered_s:.1f} s, and the torque is still on"
        assert answered_s < WITHIN_S


@contextlib.contextmanager
def bench(folder: Path, *, descriptors: int | None = None) -> Iterator[Bench]:
    with serving(folder, "--time-scale", "0.5") as (_, file), contextlib.ExitStack() as stack:
        file.write_text(re.sub(r'^name = ".*"', 'name = "bench"', file.read_text(), count=1, flags=re.M))
        observer = Observer(tomllib.loads(file.read_text())["buses"]["rmcu"]["channel"])
        stack.callback(observer.close)
        limited = ("sh", "-c", f'ulimit -n {descriptors}; exec "$@"', "sh") if descriptors else ()
        arguments = ("--bench", str(file), "--rate", "1000")
        service = stack.enter_context(
            served(folder / "data", *arguments, state=folder / "state", through=limited)
        )
        service.give("attacked", PLAN)
        client = Client(service.url)
        yield Bench(service, client, client.find_stop_post(), observer)


@pytest.mark.slow
@pytest.mark.parametrize("attack", ["half_open", "hostile_model", "hostile_plan", "locked_database"])
def test_a_stop_is_answered_under_attack_and_the_torque_goes(attack: str, tmp_path: Path) -> None:
    with bench(tmp_path) as one:
        run = one.run_with_torque_on()
        with getattr(attacks, attack)(one.service):
            one.stop()
        over = one.over(run)
        assert (over["exit_code"], over["safe_state"]) == (3, "confirmed")
        result = one.service.get(f"/runs/{run}/files/result.json")
        stop = result["emergency_stop"]
        assert (stop["by"], stop["origin"], stop["way"]) == ("somebody at 127.0.0.1", "127.0.0.1", "api")
        assert "typed e" not in json.dumps(result)


@pytest.mark.slow
def test_neither_eaten_descriptors_nor_half_open_stop_posts_hold_a_stop_up(tmp_path: Path) -> None:
    with bench(tmp_path, descriptors=256) as one:
        run = one.run_with_torque_on()
        with (
            attacks.half_open(one.service, 400),
            attacks.half_open(one.service, 400, at=one.stop_url),
        ):
            time.sleep(2.0)
            one.stop()
            assert one.service.process.poll() is None
        assert one.over(run)["exit_code"] == 3
        one.stop()  # it answers as if nothing had been
        with pytest.raises(RefusedError, match="the axle turns"):  # nothing brakes it
            one.service.post("/benches/bench/reset")


@pytest.mark.slow
def test_a_stop_post_that_was_killed_is_there_again_and_knows_the_run(tmp_path: Path) -> None:
    with bench(tmp_path) as one:
        run = one.run_with_torque_on()
        _kill_stop_post(one.service)
        until_s = time.monotonic() + 60
        while not (url := one.service.get("/health")["stop_url"]):
            assert time.monotonic() < until_s
            time.sleep(0.1)
        answer = Served(one.service.process, url, one.service.data).post("/emergency-stop")
        assert answer == {"stopped": [{"bench": "bench", "run": run}]}
        assert one.over(run)["exit_code"] == 3


def _kill_stop_post(service: Served) -> None:
    (post,) = [
        int(child)
        for child in Path(f"/proc/{service.process.pid}/task/{service.process.pid}/children")
        .read_text()
        .split()
        if b"hil.service.stop_post" in Path(f"/proc/{child}/cmdline").read_bytes()
    ]
    subprocess.run(["kill", "-9", str(post)], check=True)
    until_s = time.monotonic() + 30
    while service.get("/health")["stop_url"]:
        assert time.monotonic() < until_s
        time.sleep(0.02)


def test_the_command_line_knows_a_port_for_stops(tmp_path: Path) -> None:
    command = [*HIL, "serve", "--data", str(tmp_path / "data"), "--port", "0", "--stop-port", "70000"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment_of(tmp_path), check=False)
    assert done.returncode == 2
