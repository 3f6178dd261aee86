"""A master of others, pyxcp's own command and its DAQ, at the emulated RMCU over an emulated slcan adapter.

pyxcp is under the LGPL: it is installed by name into a folder of its own, and nothing here imports it.
"""

from __future__ import annotations

import csv
import os
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tests.readers.tools import PLACE, NotHereError, ran

CONFIGURATION = """c = get_config()
c.Transport.layer = "CAN"
c.Transport.Can.interface = "slcan"
c.Transport.Can.channel = "{channel}"
c.Transport.Can.bitrate = 1000000
c.Transport.Can.can_id_master = 0x550
c.Transport.Can.can_id_slave = 0x551
c.Transport.Can.max_dlc_required = True
c.Transport.Can.SlCan.sleep_after_open = 0.0
"""
MEASURING = """import time
from pyxcp.cmdline import ArgumentParser
from pyxcp.daq_stim import DaqList, DaqToCsv
both = dict(event_num=0, stim=False, enable_timestamps=True, priority=0)
parser = DaqToCsv([
    DaqList(name="fast", prescaler=1,
            measurements=[("dfc", 0x20000100, 0, "F32"), ("y", 0x2000010C, 0, "F32")],
            **both),
    DaqList(name="slow", prescaler=10, measurements=[("state", 0x2000011C, 0, "F32")], **both),
])
with ArgumentParser(description="measures").run(policy=parser) as x:
    x.connect()
    x.setMta(0x20000000)
    print("software:", x.fetch(18).decode())
    parser.setup()
    parser.start()
    time.sleep(1.0)
    parser.stop()
    x.disconnect()
"""


@pytest.fixture(scope="module")
def pyxcp() -> Path:
    folder = PLACE / "xcp"
    try:
        if not (folder / "pyxcp").is_dir():
            ran(sys.executable, "-m", "pip", "install", "--quiet", "--target", folder, "pyxcp")
    except NotHereError as error:
        pytest.skip(str(error))
    return folder


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Path]:
    """A folder with pyxcp's configuration for a bench that is being served."""
    net = tmp_path / "net.toml"
    command = [sys.executable, "-c", "from hil.cli import main; main()", "bench", "sim", "sim_whole"]
    options = ["--transport", "slcan", "--bench-file", str(net), "--for", "60"]
    with subprocess.Popen([*command, *options], stdout=subprocess.DEVNULL) as served:
        try:
            while not net.is_file():
                assert served.poll() is None
                time.sleep(0.1)
            channel = tomllib.loads(net.read_text())["buses"]["ram"]["channel"]
            (tmp_path / "pyxcp_conf.py").write_text(CONFIGURATION.format(channel=channel))
            yield tmp_path
        finally:
            served.terminate()


def said(folder: Path, place: Path, *arguments: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=place, env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_its_command_finds_what_there_is(pyxcp: Path, place: Path) -> None:
    told = said(pyxcp, place, "-c", "from pyxcp.scripts.xcp_info import main; main()")
    for words in ("ASCII_TEXT: emulated RMCU", "'supportsDaq': True", "'name': 'control cycle'", "'cycle': 1",
                  "'DYNAMIC'", "'timestampSupported': True", "Done."):  # fmt: skip
        assert words in told


@pytest.mark.slow
def test_it_measures_two_lists_at_once(pyxcp: Path, place: Path) -> None:
    (place / "measure.py").write_text(MEASURING)
    assert "software: RMCU 1.0.0 DA2024A" in said(pyxcp, place, "measure.py")
    rows = {
        name: list(csv.reader((place / f"{name}.csv").read_text().splitlines()))[1:]
        for name in ("fast", "slow")
    }
    assert 900 < len(rows["fast"]) < 1200
    assert 90 < len(rows["slow"]) < 120
    stamps = [int(row[1]) for row in rows["fast"]]  # ns since the first, by the slave's clock
    assert {later - earlier for earlier, later in pairwise(stamps)} == {1_000_000}
