"""A model identified from a run on the page, and a diagnosis whose separating test is one click away."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright import sync_api as playwright

from tests.hil.service.frontend.browsed import IN_A_BROWSER, answer, choice, expect, heading, region, to
from tests.hil.service.jobs.test_studies import CHIRP
from tests.hil.service.looks import expect_drawn, refuse_hard_to_use
from tests.hil.service.served import SHORT, Served, served

pytestmark = IN_A_BROWSER
_BANDS = [[0.0, 1.0], [1.0, 3.0], [3.0, 6.0], [6.0, 10.0], [10.0, 15.0], [15.0, 30.0], [30.0, 125.0]]
_CHANNELS = ["motor_speed_rad_s", "wheel_speed_rad_s", "shaft_torque_nm"]


def _diagnosis() -> dict[str, Any]:
    """As `hil diagnose` writes it of backlash that may be dry friction too."""
    where = {"channels": ["shaft_torque_nm"], "band_hz": [1.0, 10.0], "condition": "torque reversals"}
    effect = {
        "id": "backlash", "parameters": {"gap_rad": 0.02}, "standard_error": {"gap_rad": 0.001},
        "derived": {}, "confidence": 0.81, "where": where,
    }  # fmt: skip
    other = {
        "id": "coulomb_friction", "parameters": {}, "confidence": 0.17,
        "separating_test": "a step without reversal", "plan": "separate_friction.yaml",
    }  # fmt: skip
    gap = {name: {"before": 0.12, "after": 0.011, "noise_floor": 0.01} for name in _CHANNELS}
    before = [[[40.0, 12.5, 9.0, 3.0, 1.2, 1.0, None] for _ in _CHANNELS]]
    after = [[[1.1, 1.0, 1.0, 1.0, 1.0, 1.0, None] for _ in _CHANNELS]]
    return {
        "format": 1, "verdict": "named", "effects": [effect], "alternatives": [other], "gap": gap,
        "holdout_gap": {}, "remaining_gap": "", "parameter_updates": {}, "notes": [], "model": "model.toml",
        "map": {
            "recordings": ["run 1"], "channels": _CHANNELS, "bands_hz": _BANDS,
            "before": before, "after": after,
        },
    }  # fmt: skip


def _of_an_earlier_day(data: Path) -> None:
    """A diagnosis that a service had made before this one began."""
    results = data / "studies/000001/results"
    results.mkdir(parents=True)
    study = {
        "id": 1, "kind": "diagnosis", "state": "ended", "runs": [1], "model": "three_inertia",
        "requested_by": "anna", "asked_at": "2026-01-01T12:00:00Z", "ended_at": "2026-01-01T12:05:00Z",
    }  # fmt: skip
    (results.parent / "study.json").write_text(json.dumps(study), "utf-8")
    (results / "diagnosis.json").write_text(json.dumps(_diagnosis()), "utf-8")
    plan = SHORT.replace("name: short", "name: separate_friction\ntitle: To tell friction from backlash")
    (results / "separate_friction.yaml").write_text(plan, "utf-8")


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("page-studies")
    _of_an_earlier_day(folder / "data")
    with served(folder / "data", state=folder / "state") as service:
        service.give("chirp", CHIRP)
        service.over(service.queue("chirp"))
        yield service


def test_map_name_and_shrink_are_shown_and_the_separating_test_is_run(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "diagnoses")
    page.get_by_role("link", name="1", exact=True).first.focus()
    page.keyboard.press("Enter")
    expect(heading(page, re.compile("Diagnosis 1"))).to_be_visible()
    effects = region(page, "Effects that the model lacks named")
    expect(effects).to_contain_text("backlash (81 %): gap_rad = 0.02 ± 0.001")
    expect(region(page, "Error over noise, before → after")).to_contain_text("40.0 → 1.10")
    expect(region(page, "Gap, % of the signal")).to_contain_text("12 %1.1 %1 %")
    refuse_hard_to_use(page)
    page.get_by_role("button", name="Run the separating test on sim for coulomb friction").click()
    expect(heading(page, re.compile("To tell friction from backlash"))).to_be_visible()
    there.over(int(page.url.rpartition("/")[2]))


def test_a_model_is_identified_from_a_run_kept_designed_for_and_diagnosed(
    page: playwright.Page, there: Served
) -> None:
    to(page, there, "runs/1")
    page.get_by_role("link", name="Identify a model").click()
    expect(page.get_by_label("run 1: chirp, sim")).to_be_checked()
    page.get_by_role("button", name="Identify", exact=True).click()
    expect(page.get_by_text(re.compile("resonance 11"))).to_be_visible(timeout=240_000)
    expect(region(page, "Parameters").locator("table")).to_contain_text("gear ratio")
    gain = page.locator("figure.plot", has_text="Gain to motor speed")
    expect_drawn(gain, "gain", "phase")
    expect_drawn(page.locator("figure.plot", has_text="Coherence"), "gain")
    orders = region(page, "Orders side by side")
    expect(orders.locator("tbody tr")).to_have_count(7)
    expect(orders.locator("tbody")).to_contain_text("taken by hil identify")
    orders.get_by_role("radio", name="order 6", exact=True).check()
    expect_drawn(gain, "gain", "phase", "third")
    expect(page.get_by_text("order_6.toml", exact=True).first).to_be_visible()
    expect(region(page, "Chains side by side").locator("thead")).to_contain_text("three inertia")
    region(page, "Chains side by side").get_by_role("radio", name="three inertia").check()
    page.get_by_label("Name", exact=True).fill("found")
    page.get_by_role("button", name="Save the model").click()
    expect(page.get_by_text("Saved as found")).to_be_visible()
    refuse_hard_to_use(page)
    page.get_by_role("link", name="design", exact=True).click()
    expect(choice(page, "Model")).to_have_value("found")
    expect(region(page, "Margins and peaks").locator("table")).to_contain_text("gain margin")
    page.go_back()
    page.get_by_role("button", name="Remove").click()
    answer(page, "Remove")
    expect(page.get_by_text("None yet.")).to_be_visible()
    to(page, there, "runs/1")
    page.locator("main").get_by_role("link", name="Diagnose", exact=True).click()
    choice(page, "Model").select_option("found")
    page.get_by_label("Time limit").fill("0.1")
    page.get_by_role("button", name="Diagnose", exact=True).click()
    expect(heading(page, re.compile("Diagnosis 3"))).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    expect(heading(page, re.compile("Diagnosis 3 (cancelled|ended)"))).to_be_visible()


def test_only_runs_of_plans_with_chirps_or_multisines_are_offered_to_identify(
    page: playwright.Page, there: Served
) -> None:
    there.give("short", SHORT)
    there.over(run := there.queue("short"))
    to(page, there, "identifications")
    offered = page.get_by_role("group", name="Runs with chirps or multisines")
    expect(offered.get_by_role("checkbox", name="run 1: chirp")).to_be_visible()
    expect(offered.get_by_role("checkbox", name=f"run {run}:")).to_have_count(0)
    to(page, there, "diagnoses")
    expect(page.get_by_role("checkbox", name=f"run {run}: short").first).to_be_visible()
