"""What outlives its loop must not be able to send: no cyclic sender of python-can, no job of the kernel's."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
#: Of python-can and canopen: each makes a thread, or a job of the kernel, that sends by itself.
CYCLIC = {
    "send_periodic",
    "start_heartbeat",
    "start_node_guarding",
    "CyclicSendTask",
    "ThreadBasedCyclicSendTask",
    "CAN_BCM",
    "Notifier",
    "add_periodic_callback",
}


def names_in(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.ImportFrom):
            yield from (alias.name for alias in node.names)


def test_nothing_that_holds_a_bench_sends_by_itself() -> None:
    files = [file for package in ("hil", "drivers") for file in (ROOT / package).rglob("*.py")]
    assert len(files) > 100
    assert {(file.name, name) for file in files for name in names_in(file) if name in CYCLIC} == set()


def test_a_cyclic_sender_is_seen(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("bus.send_periodic(message, 0.01)\n")
    assert "send_periodic" in set(names_in(tmp_path / "a.py"))
