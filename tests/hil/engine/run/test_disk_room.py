"""Too little room on the disk: refused before, warned of when it is close, told with the disk's name."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hil.core.errors import BadInputError
from hil.core.files import disk_of
from hil.engine.run.preflight import needed_bytes, refuse_too_little_room, remark_on_room
from test_plans import Plan
from tests.benches_for_tests import plan

HOUR = plan("[{hold_speed: {speed_km_h: 0, duration_s: 3600}}]")


def lasting(seconds: float) -> Plan:
    """Longer than any plan that can be read."""
    return HOUR.model_copy(update={"steps": HOUR.steps * round(seconds / 3600)})


def test_a_run_that_cannot_fit_is_refused_and_one_that_just_fits_is_warned_of(tmp_path: Path) -> None:
    free = shutil.disk_usage(tmp_path).free
    just = lasting(0.7 * free / 250_000)
    refuse_too_little_room([just], tmp_path)
    assert str(disk_of(tmp_path)).partition(",")[0] in remark_on_room(just, tmp_path)
    with pytest.raises(BadInputError, match=r"MB are free, the recording may need .* disk at /"):
        refuse_too_little_room([lasting(1.5 * free / 250_000)], tmp_path)
    with pytest.raises(BadInputError, match=r"MB are free, 3 runs may need .* disk at /"):
        refuse_too_little_room([lasting(0.5 * free / 250_000)], tmp_path / "not" / "made", times=3)
    assert remark_on_room(lasting(1.0), tmp_path) == "" or free < 2 * needed_bytes(lasting(1.0))


def test_a_disk_is_known_by_where_it_is_mounted(tmp_path: Path) -> None:
    assert disk_of(tmp_path / "not" / "there").startswith("disk at /")
    if Path("/dev/shm").is_mount():
        assert disk_of(Path("/dev/shm/x")).startswith("disk at /dev/shm, ")
