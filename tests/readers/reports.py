"""A report of every command that writes one besides the run, for others' validators."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

HIL = Path(sys.executable).parent / "hil"
_ROOT = Path(__file__).parents[2]
_MODEL = str(_ROOT / "benches/three_inertia.toml")
_CONTROLLERS = _ROOT / "test_plans/library/controllers"
_CAMPAIGN = """format: 1
name: few
plan: mine/plan.yaml
controllers: [phase_stabilization, gain_stabilization]
draws: 10
tolerance: {tyre_stiffness: 0.2, dead_time_s: 0.001}
"""

#: Of each command what it is given; it stands in the folder of its inputs and writes to one of its own name.
REPORTS: dict[str, tuple[str, ...]] = {
    "identify": ("identification/recording.mcap",),
    "design": ("--model", _MODEL),
    "diagnose": (
        *("--model", "mine/axle.toml", "mine/chirp_high.csv", "mine/chirp_low.csv", "mine/steps.csv"),
        *("--holdout", "mine/multisine.csv"),
    ),
    "compare": ("gain", "phase"),
    "tune": ("mine/plan.yaml", "--model", _MODEL, "--starts", "2"),
    "campaign": ("few.yaml", "--workers", "0"),
    "explain": (
        *("--target", "gain_0kmh.peak_shaft_torque=534", "--target", "gain_20kmh.peak_shaft_torque=723"),
        *("--target", "phase_20kmh.peak_shaft_torque=564", "--evaluations", "60"),
    ),
}


def inputs(folder: Path) -> None:
    """What the commands read."""
    _carried_out(folder, "init", "mine", "--samples")
    _carried_out(folder, "run", "short_identification", "--out", "identification")
    for name in ("gain", "phase"):
        controller = str(_CONTROLLERS / f"{name}_stabilization.toml")
        _carried_out(folder, "run", "mine/plan.yaml", "--controller", controller, "--out", name)
    (folder / "few.yaml").write_text(_CAMPAIGN, encoding="utf-8")


def written(folder: Path, command: str) -> Path:
    """The folder that has report.html and report.pdf of a command."""
    _carried_out(folder, command, *REPORTS[command], "--out", command)
    return folder / command


def _carried_out(folder: Path, *arguments: str) -> None:
    done = subprocess.run([HIL, *arguments], cwd=folder, capture_output=True, text=True, timeout=1200)
    assert done.returncode in (0, 1), (arguments, done.stderr[-1000:])  # 1: a criterion failed
