"""The page of kinds of files is what the readers say now, and has every ending of theirs."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil.core import can_logs
from hil.core.recording import READ
from tests.file_kinds.__main__ import PAGE, page
from tests.file_kinds.cases import LOGS, TABLES


def test_the_page_is_fresh() -> None:
    pytest.importorskip("h5py")
    pytest.importorskip("nptdms")
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m tests.file_kinds --write"


def test_every_ending_that_is_read_has_a_file() -> None:
    assert {Path(case.name).suffix for case in TABLES} >= set(READ)
    binary = {".mcap", ".blf", ".trc"}  # of frames: tests/hil/core/can_logs writes these by python-can
    assert {Path(case.name).suffix for case in LOGS} | binary >= set(can_logs.READ)
