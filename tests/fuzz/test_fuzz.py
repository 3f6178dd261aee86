"""Damaged files and frames: a little at each run, more in the slow set, an hour by `make fuzz`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.targets import TARGETS
from tests.fuzz.trying import try_many

MANY = {"frames": 60, "bench": 100, "dbc": 100, "eds": 60}


@pytest.mark.parametrize("name", TARGETS)
def test_damaged_input_is_refused_or_read(name: str, tmp_path: Path) -> None:
    assert try_many(name, 1, tmp_path, most=4) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_much_damaged_input_is_refused_or_read(name: str, tmp_path: Path) -> None:
    assert try_many(name, 2, tmp_path, most=MANY.get(name, 300)) == []
