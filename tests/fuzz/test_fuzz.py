"""Damaged files and frames: a little at each run, more in the slow set, an hour by `make fuzz`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.targets import TARGETS
from tests.fuzz.trying import try_many
from tests.fuzz.watched import left_alone

MANY = {"frames": 60, "bench": 100, "dbc": 100, "eds": 60}


@pytest.mark.parametrize("name", TARGETS)
def test_damaged_input_is_refused_or_read(name: str, tmp_path: Path) -> None:
    assert try_many(name, 1, tmp_path, most=4) == []


def test_parsers_are_watched_and_what_is_compiled_is_not() -> None:
    left = set(left_alone())
    assert left >= {"hil.plant", "hil.plant.closed_loop.advance", "hil.core.effects.backlash", "drivers.loop"}
    watched = {
        "hil.core.recording._mcap_reader",
        "test_plans.loading",
        "hil.engine.bench.bench_file",
        "hil.core.can.eds",
    }
    assert not left & watched


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_much_damaged_input_is_refused_or_read(name: str, tmp_path: Path) -> None:
    assert try_many(name, 2, tmp_path, most=MANY.get(name, 300)) == []
