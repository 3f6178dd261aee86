"""A minute of frames at the pace that the emulated machine can just take."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.can_vm.at_the_limit import recorded

pytestmark = pytest.mark.skipif(
    "HIL_CAN_VM_INSIDE" not in os.environ,
    reason="no emulated CAN controllers here: make test-can-vm has them",
)

MINUTE_S = 60.0
SLOWER = 0.8


def test_a_minute_at_the_limit_of_this_machine_is_recorded_without_a_loss(tmp_path: Path) -> None:
    """The fastest pace of which two seconds are lossless, a fifth slower, for a minute."""
    fastest, gap_s = 0.0, 0.0
    for gap_ms in (1.0, 0.5, 0.25):
        counted = recorded("simcan0", "simcan1", gap_ms, int(2e3 / gap_ms), tmp_path / f"{gap_ms}.mcap")
        print(f"\n{counted}")
        if counted.lossless and counted.rate > fastest:
            fastest, gap_s = counted.rate, 1e-3 * gap_ms
    assert fastest > 0
    pace = SLOWER * fastest
    gap_ms = 1e3 * (gap_s + 1 / pace - 1 / fastest)  # sending itself takes as long as it did
    minute = recorded("simcan0", "simcan1", round(gap_ms, 3), int(MINUTE_S * pace), tmp_path / "minute.mcap")
    print(f"\n{MINUTE_S:g} s at {minute.rate:.0f} frames/s: {minute}")
    assert minute.lossless
    assert minute.recorded / minute.rate >= 0.95 * MINUTE_S
