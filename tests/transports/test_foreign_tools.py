"""Other people's tools on a served bench: python-can's viewer and logger, canopen as a master of its own."""

from __future__ import annotations

import os
import re
import select
import signal
import struct
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import can
import canopen
import pytest

from tests.benches_for_tests import SIM
from tests.hil.cli.test_sim_bench import serving

ROWS, COLUMNS = 40, 120
DYNO = 3


@pytest.fixture(scope="module")
def buses(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """Where the buses of a bench in another process are."""
    with serving(tmp_path_factory.mktemp("served"), "--time-scale", "0.5") as (_, file):
        yield tomllib.loads(file.read_text())["buses"]


@pytest.mark.slow
def test_the_viewer_shows_the_devices(buses: dict[str, Any]) -> None:
    """In a terminal, as a person opens it; it ends when told so by its own key."""
    fcntl, pty, termios = (pytest.importorskip(name) for name in ("fcntl", "pty", "termios"))
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    command = [sys.executable, "-m", "can.viewer", "-i", "hil-udp", "-c", buses["rmcu"]["channel"]]
    viewer = subprocess.Popen(
        command,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env={**os.environ, "TERM": "xterm", "ESCDELAY": "25"},
    )
    os.close(theirs)
    shown, wanted = "", {"0x110", "0x111", "0x200"}
    for _ in range(600):
        if select.select([ours], [], [], 0.1)[0]:
            shown += os.read(ours, 65536).decode("utf-8", "replace")
        if wanted <= set(re.findall(r"0x[0-9A-F]{3}", shown)):
            break
    os.write(ours, b"q")
    assert wanted <= set(re.findall(r"0x[0-9A-F]{3}", shown)), shown[-2000:]
    try:
        viewer.wait(30)
    except subprocess.TimeoutExpired:  # its last page waits to be read
        viewer.kill()
    finally:
        os.close(ours)


@pytest.mark.slow
def test_the_logger_writes_what_python_can_reads_again(buses: dict[str, Any], tmp_path: Path) -> None:
    file = tmp_path / "bus.asc"
    command = [sys.executable, "-m", "can.logger", "-i", "hil-udp", "-c", buses["rmcu"]["channel"]]
    logger = subprocess.Popen([*command, "-f", str(file)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    for _ in range(600):
        if file.exists() and file.stat().st_size > 20_000:
            break
        time.sleep(0.05)
    logger.send_signal(signal.SIGINT)
    said, _ = logger.communicate(timeout=30)
    with can.LogReader(str(file)) as reader:
        messages = list(reader)
    assert {0x110, 0x111, 0x112, 0x200} == {message.arbitration_id for message in messages}, said
    status = [message.timestamp for message in messages if message.arbitration_id == 0x110]
    apart = [after - before for before, after in pairwise(status)]
    assert sorted(apart)[len(apart) // 2] == pytest.approx(0.002, rel=0.1)  # 1 ms at half of real time


@pytest.mark.slow
def test_canopen_as_a_master_of_its_own_configures_and_reads_a_dyno(buses: dict[str, Any]) -> None:
    network = canopen.Network()
    network.connect(interface="hil-udp", channel=buses["dyno"]["channel"])
    try:
        network.scanner.search(limit=8)
        time.sleep(1.0)
        assert set(network.scanner.nodes) == set(SIM.dyno.nodes.values()) - {SIM.dyno.host_node}
        node = network.add_node(DYNO, str(SIM.dyno.eds))
        node.sdo.RESPONSE_TIMEOUT = 2.0
        assert node.sdo[0x1000].raw & 0xFFFF == 402
        node.nmt.wait_for_heartbeat(timeout=10)
        node.sdo[0x1017].raw = 50
        assert node.sdo[0x1017].raw == 50
        node.nmt.state = "OPERATIONAL"
        assert node.nmt.wait_for_heartbeat(timeout=10) in ("OPERATIONAL", "PRE-OPERATIONAL")
        with pytest.raises(canopen.SdoAbortedError):
            node.sdo.download(0x5FFF, 0, b"\x00")
    finally:
        network.disconnect()
