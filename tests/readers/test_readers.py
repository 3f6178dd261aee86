"""The same checks on a short run, where the tools can be had."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.readers.__main__ import PAGE, made
from tests.readers.checks import Check, checks, checks_of_reports
from tests.readers.tools import NotHereError

PLAN = """
name: short
steps:
  - set_controller: {file: phase_stabilization.toml}
  - hold_speed: {speed_km_h: 10, duration_s: 0.5}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 200, before_s: 0.5, after_s: 2}
finally:
  - ramp_down: {duration_s: 0.2}
criteria:
  - {segment: s, metric: peak_shaft_torque, upper: 400, unit: N m}
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("written")
    (folder / "plan.yaml").write_text(PLAN)
    made(folder / "out", folder / "plan.yaml")
    return folder / "out"


@pytest.mark.slow
@pytest.mark.parametrize("check", list(checks()), ids=lambda check: f"{check.output}-{check.tool}")
def test_others_read_what_is_written(check: Check, written: Path) -> None:
    try:
        version, result = check.read(written)
    except NotHereError as error:
        pytest.skip(str(error))
    assert version
    assert result


def test_the_page_names_every_check_and_no_failure() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert all(f"| {check.output} | {check.tool} |" in page for check in (*checks(), *checks_of_reports()))
    assert "FAILED" not in page
