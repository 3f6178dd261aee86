"""Two runs on one bench: the second is refused, by the bus and not by the bench file's name."""

from __future__ import annotations

import contextlib
from typing import Any

import pytest

from hil.core.errors import BenchError
from hil.engine.bench.bench_lock import alone_on
from hil.engine.bench.bench_tables import Bus
from tests.benches_for_tests import SIM


def bench(**tables: dict[str, Any]):
    buses = {name: Bus.model_validate({"bit_rate": 1_000_000, **table}) for name, table in tables.items()}
    return SIM.model_copy(update={"buses": buses, "simulation": None})


def udp(port: int) -> dict[str, Any]:
    return {"interface": "hil-udp", "channel": f"127.0.0.1:{port}"}


def test_a_bench_that_shares_one_bus_is_refused_and_names_it() -> None:
    with (
        alone_on(bench(rmcu=udp(1), dyno=udp(2))),
        pytest.raises(BenchError, match=r"(?s)bus 'wheels': the bench is in use: .*hil-udp 127.0.0.1:2"),
        alone_on(bench(rmcu=udp(3), wheels=udp(2))),
    ):
        pass
    with alone_on(bench(rmcu=udp(3), wheels=udp(2))):
        pass


def test_options_of_the_adapter_make_no_other_bench() -> None:
    with (
        alone_on(bench(rmcu=udp(1))),
        pytest.raises(BenchError, match="in use"),
        alone_on(bench(rmcu=udp(1) | {"options": {"receive_own_messages": True}})),
    ):
        pass


def test_other_buses_and_benches_inside_the_process_do_not_collide() -> None:
    with contextlib.ExitStack() as stack:
        stack.enter_context(alone_on(bench(rmcu=udp(1), dyno=udp(1))))  # two tables of one bus
        stack.enter_context(alone_on(bench(rmcu=udp(4))))
        stack.enter_context(alone_on(SIM))
        stack.enter_context(alone_on(SIM))


def test_an_adapter_is_known_by_what_its_link_points_to(tmp_path) -> None:
    (tmp_path / "ttyACM0").touch()
    (tmp_path / "by-id").symlink_to(tmp_path / "ttyACM0")
    one, other = (
        bench(rmcu={"interface": "slcan", "channel": str(tmp_path / name)}) for name in ("ttyACM0", "by-id")
    )
    with alone_on(one), pytest.raises(BenchError, match="in use"), alone_on(other):
        pass


def test_a_table_that_names_no_adapter_may_mean_any_of_them() -> None:
    def kvaser(**options: object):
        return bench(rmcu={"interface": "kvaser", "channel": 0, "options": options})

    with alone_on(kvaser(serial=5)), alone_on(kvaser(serial=6)):
        for other in (kvaser(), kvaser(serial=5, receive_own_messages=True)):
            with pytest.raises(BenchError, match="in use"), alone_on(other):
                pass
    for other in (kvaser(serial=5), kvaser()):
        with alone_on(kvaser()), pytest.raises(BenchError, match="in use"), alone_on(other):
            pass
    with alone_on(kvaser()):
        pass
