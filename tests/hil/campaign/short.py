"""A short campaign: a plan of two seconds on a few cars, written into a folder."""

from __future__ import annotations

from pathlib import Path

from tests.hil.analysis.tuning.trials import PLAN

CAMPAIGN = """
name: short_campaign
plan: short.yaml
controllers: [phase_stabilization, gain_stabilization]
vary:
  controller.feed_forward_time_s: [0.05, 0.15]
  model.vehicle_inertia: {from: 250, to: 350, count: 2}
draws: 2
seed: 3
tolerance: {tyre_stiffness: 0.2, sensor_noise: 1}
"""


def written(folder: Path, text: str = CAMPAIGN) -> Path:
    """The campaign's file, beside its plan."""
    (folder / "short.yaml").write_text(PLAN)
    (folder / "campaign.yaml").write_text(text)
    return folder / "campaign.yaml"
