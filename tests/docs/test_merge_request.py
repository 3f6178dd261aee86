"""The filters of the page make a table in Markdown of what a run and a comparison write."""

from __future__ import annotations

import json
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from hil.core.result import CriterionResult, RunResult
from tests.docs.documented import blocks_of

PAGE = "docs/how-to/merge-request.md"
RESULT = RunResult(
    verdict="fail",
    plan="tip_in",
    bench="sim",
    real_time_factor=1.0,
    bench_time_s=20.0,
    safe_state="confirmed",
    criteria=(
        CriterionResult(id="s.peak", value=512.0, unit="N m", lower=-10.0, upper=500.0, verdict="fail"),
        CriterionResult(id="s.settling", value=None, unit="s", below="t", verdict="did_not_settle"),
    ),
)
COMPARISON = {"criteria": [{"id": "s.peak", "unit": "N m", "values": [512.0, None]}]}


def table_of(block: str, folder: Path) -> list[str]:
    command = shlex.split(block.partition("> comment.md")[0].replace("\\\n", " "), posix=True)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


@pytest.mark.skipif(shutil.which("jq") is None, reason="jq is not installed")
def test_the_filters_make_a_table(tmp_path: Path) -> None:
    of_a_run, of_a_comparison = blocks_of(PAGE, "sh")
    for name, text in (
        ("mine/result.json", RESULT.model_dump_json()),
        ("compare/comparison.json", json.dumps(COMPARISON)),
    ):
        path = tmp_path / "out" / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    assert table_of(of_a_run, tmp_path)[-2:] == [
        "| s.peak | 512 N m | ≥ -10 ≤ 500 | fail |",
        "| s.settling | – s | below t | did_not_settle |",
    ]
    assert table_of(of_a_comparison, tmp_path)[-1] == "| s.peak | 512 | – | N m |"
