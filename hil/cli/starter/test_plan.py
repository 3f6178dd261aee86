"""The plan on the simulated bench: `pytest` carries it out and judges it."""

from pathlib import Path

from hil.engine import RunRequest, load_bench, run_plan
from test_plans import load_plan

HERE = Path(__file__).parent


def test_every_criterion_passes(tmp_path: Path) -> None:
    """The axle that bench.toml simulates keeps every limit of plan.yaml."""
    plan, bench = load_plan(HERE / "plan.yaml"), load_bench(HERE / "bench.toml")
    outcome = run_plan(RunRequest(plan, bench, tmp_path))
    assert outcome.error is None
    assert outcome.result.safe_state == "confirmed"
    assert [criterion.id for criterion in outcome.result.criteria if criterion.failed] == []
    assert outcome.result.verdict == "pass"
