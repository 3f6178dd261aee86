"""Counts add up over other people's own test files, which are fetched by name and not kept here.

can-utils' source has no log of its own: what its log2asc and asc2log write is held in `checks`.
"""

from __future__ import annotations

import datetime
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import asammdf
import can
import numpy as np
import pytest

from hil.core.can.dbc_messages import keys_of
from hil.core.can_logs import CanLog, read_can_log
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from hil.core.recording.mdf import open_mdf, read_mdf
from hil.engine.replay._counts import counted
from tests.readers import tools

pytestmark = pytest.mark.slow
_DATES = re.compile(r"^(?:date|begin triggerblock)\s+\w+\s+(.+?)\s*$", re.IGNORECASE | re.MULTILINE)


def fetched(source: Callable[[], Path]) -> Path:
    """A source package.

    Skips the test where no index can be reached, with what was stated.
    """
    try:
        return source()
    except (tools.NotHereError, OSError) as error:
        pytest.skip(f"no source package: {error}")


def split(log: CanLog) -> int:
    """Frames in all counts of a log, of which half the identifiers are known."""
    blocks = list(log.channels.values())
    keys = np.unique(np.concatenate([keys_of(block) for block in blocks])).tolist()
    counts = counted([log], [(block, keys[::2]) for block in blocks], 0)
    whole = counts.as_json()
    parts = ("decoded", "short", "of_no_message", "error")
    assert whole["all"] == sum(whole[part] for part in parts) + sum(whole["refused"].values())
    return counts.all


def test_every_frame_of_python_cans_logs_ends_in_one_count() -> None:
    source = fetched(tools.python_can_source)
    tried = 0
    for path in sorted((source / "test/data").iterdir()):
        if path.suffix not in (".asc", ".blf", ".trc", ".log"):
            continue
        with can.LogReader(path) as reader:
            wanted = len(list(reader))
        try:
            found = split(read_can_log(path))
        except BadInputError as error:  # a log of nothing but what no recording has a place for
            assert "has no data frames" in error.what, (path.name, error)
            found = sum(map(int, re.findall(r"(\d+) (?:remote|CAN FD|frames)", error.fix)))
        assert found == wanted, path.name
        tried += 1
    assert tried >= 20


def test_stamps_of_python_cans_asc_logs_lie_where_their_dates_say() -> None:
    """Where the date in the head is that of the only trigger block, python-can's own stamps are right."""
    source = fetched(tools.python_can_source)
    tried = 0
    for path in sorted((source / "test/data").glob("*.asc")):
        text = path.read_text("cp1252")
        dates = re.findall(
            r"^(?:date|begin triggerblock)\s+\w+\s+(.+?)\s*$", text, re.IGNORECASE | re.MULTILINE
        )
        if len(set(dates)) != 1:
            continue
        try:
            log = read_can_log(path)
        except BadInputError:
            continue
        with can.ASCReader(path, relative_timestamp=False) as reader:
            wanted = min(message.timestamp for message in reader)
        if log.began_ns is None or datetime.datetime.fromtimestamp(wanted).year < 1980:
            continue
        first_s = min(float(block["time_s"][0]) for block in log.channels.values())
        assert log.began_ns * 1e-9 + first_s == pytest.approx(wanted, abs=1.0), path.name
        tried += 1
    assert tried >= 3


def channels_of(path: Path) -> list[str]:
    with open_mdf(path) as mdf:
        return [str(c.name) for group in mdf.groups for c in group.channels if c.channel_type not in (2, 3)]


def accounted(found: Recording) -> int:
    """Channels that were read, and those that a note names as left out."""
    left_out = [note for note in found.notes if "left out" in note or "the first was taken" in note]
    return len(found.channels.keys() - {"time_s"}) + len(left_out)


def test_every_channel_of_asammdfs_files_is_read_or_named() -> None:
    source = fetched(lambda: tools.source_package("asammdf", asammdf.__version__))
    tried = 0
    for path in sorted((source / "test").rglob("*.mf4")):
        with pytest.raises(BadInputError, match="holds channels and no CAN frames"):
            read_can_log(path)
        found: Any = read_mdf(path)
        assert accounted(found) == len(channels_of(path)), (path.name, found.notes)
        tried += 1
    assert tried >= 3
