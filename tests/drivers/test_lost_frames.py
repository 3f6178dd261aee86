"""A frame that is lost is asked for again within the deadline; what comes twice answers nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from hil.core.can.frames import FrameBlock
from hil.core.controller import load_controller
from hil.core.errors import BenchError
from sim_backend.bench import DYNO_BUS, RMCU_BUS, Fault
from sim_backend.can_interface import attached
from test_plans import load_plan
from tests.benches_for_tests import running

CONTROLLER = load_plan("acceptance").source.parent / "controllers/phase_stabilization.toml"
Lost = Callable[[int], bool]


class Wires:
    """Loses frames by identifier, and counts the requests that hosts send."""

    def __init__(
        self, bus: str, *, to_nodes: Lost = lambda i: False, to_hosts: Lost = lambda i: False
    ) -> None:
        self.bus, self._to_nodes, self._to_hosts = bus, to_nodes, to_hosts
        self.sent: list[tuple[int, bytes]] = []

    def time_passes(self, now_s: float) -> None:
        pass

    def look(self, first: int, rows: Any) -> None:
        pass

    def to_hosts(self, bus: str, block: FrameBlock) -> FrameBlock:
        if bus != self.bus or not len(block):
            return block
        return block[np.array([not self._to_hosts(int(i)) for i in block["id"]])]

    def to_nodes(self, bus: str, frame_id: int, data: bytes) -> Iterable[tuple[int, bytes]]:
        if bus != self.bus:
            return [(frame_id, data)]
        self.sent.append((frame_id, data))
        return [] if self._to_nodes(frame_id) else [(frame_id, data)]


@contextmanager
def lossy(name: str, bus: str, **lost: Lost) -> Iterator[tuple[Any, Wires]]:
    with running(name) as bench:
        attached(name).tamper = wires = Wires(bus, **lost)
        yield bench, wires


def first(count: int, frame_id: int) -> Lost:
    """The first frames with this identifier."""
    left = [count]

    def lost(number: int) -> bool:
        left[0] -= number == frame_id
        return number == frame_id and left[0] >= 0

    return lost


def some(seed: int) -> Lost:
    random = np.random.default_rng(seed)
    return lambda number: number in (0x603, 0x583) and bool(random.random() < 0.1)


@pytest.mark.parametrize("way", ["to_nodes", "to_hosts"])
def test_an_object_is_written_although_its_frames_are_lost(way: str) -> None:
    number = 0x603 if way == "to_nodes" else 0x583
    with lossy(f"sdo-{way}", DYNO_BUS, **{way: first(3, number)}) as (bench, wires):
        bench.dyno.left.write(0x2000, 1, 250.0, "vehicle inertia")
        assert attached(f"sdo-{way}").dynos[0].number(0x2000, 1) == 250.0
    assert [frame_id for frame_id, _ in wires.sent].count(0x603) == 2 + 3


def test_every_object_is_read_right_among_many_losses() -> None:
    """What was asked twice is answered twice: the second answer is none to the next question."""
    with lossy("sdo-many", DYNO_BUS, to_nodes=some(1), to_hosts=some(2)) as (bench, _):
        for value in np.linspace(1.0, 900.0, 60):
            bench.dyno.left.write(0x2000, 1, float(value), "vehicle inertia")
            assert bench.dyno.left.read(0x1000) & 0xFFFF == 402


def test_a_text_of_several_segments_is_read_again_as_a_whole() -> None:
    lost = first(1, 0x603)
    with running("sdo-text") as bench:
        named = bench.dyno.left.read(0x1008)
        asked = []

        def second(number: int) -> bool:
            asked.append(number)
            return asked.count(0x603) == 2 and lost(number)

        attached("sdo-text").tamper = Wires(DYNO_BUS, to_nodes=second)
        assert len(named) > 4
        assert bench.dyno.left.read(0x1008) == named


def test_who_never_answers_is_named_with_the_object_and_nothing_of_the_library_is_shown(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with running("sdo-deaf") as bench:
        attached("sdo-deaf").fail(Fault.DYNO_DEAF)
        began_s = bench.loop.clock.now_s()
        with pytest.raises(
            BenchError, match=r"no answer within 0\.3 s while object 0x1018, subindex 1"
        ) as caught:
            bench.dyno.left.read(0x1018, 1)
        assert caught.value.where == "dyno 'rear left' (node 3)"
        assert bench.loop.clock.now_s() - began_s == pytest.approx(0.3, abs=0.02)
    assert "ransfer" not in capfd.readouterr().err


def test_a_refusal_says_which_object_and_what_it_means() -> None:
    with running("sdo-refused") as bench, pytest.raises(BenchError) as caught:
        bench.dyno.left.write(0x2000, 5, -1.0, "wheel radius")
    assert caught.value.where == "dyno 'rear left' (node 3)"
    assert "wheel radius (object 0x2000, subindex 5) = -1: the value is" in caught.value.what
    assert "Code 0x" not in str(caught.value)


@pytest.mark.parametrize("way", ["to_nodes", "to_hosts"])
def test_parameters_are_written_although_frames_are_lost(way: str) -> None:
    random = np.random.default_rng(3)

    def lost(number: int) -> bool:
        return number in (0x120, 0x121) and bool(random.random() < 0.1)

    with lossy(f"par-{way}", RMCU_BUS, **{way: lost}) as (bench, _):
        bench.rmcu.write_controller(load_controller(CONTROLLER))
        assert attached(f"par-{way}").rmcu._stored["k_p"] == np.float32(2.6775)


def test_a_command_by_pdo_that_is_lost_comes_again_with_the_heartbeat() -> None:
    with running("pdo") as bench:
        bench.dyno.enable(50.0)
        attached("pdo").tamper = wires = Wires(DYNO_BUS, to_nodes=first(2, 0x203))
        bench.dyno.hold_speed(4.0)
        bench.loop.run_for(1.0)
        assert bench.dyno.left.wheel_speed_rad_s == pytest.approx(4.0, abs=0.1)
        assert [frame_id for frame_id, _ in wires.sent].count(
            0x203
        ) == 3  # and no more: no one sends for ever
