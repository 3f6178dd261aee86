"""The emulated machine as one test, so that others run beside it on the second processor."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.can_vm.__main__ import why_not

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
@pytest.mark.timeout(3000)  # its clock counts instructions: on a busy machine it lasts, and changes nothing
def test_runs_over_can_controllers_of_an_emulated_machine() -> None:
    reason = why_not()
    if reason and os.environ.get("HIL_CAN_VM") != "required":
        pytest.skip(reason)
    done = subprocess.run([sys.executable, "-m", "tests.can_vm"], cwd=ROOT, check=False)
    assert done.returncode == 0
