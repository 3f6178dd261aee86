"""A car of a campaign, given to the service and run on a simulated bench, comes to what the campaign says."""

from __future__ import annotations

import json
import time

import pytest

from hil.api_schemas.campaign import CAMPAIGN_OVER, CampaignWanted
from hil.client import Client
from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.campaign.short import CAMPAIGN
from tests.hil.service.served import RefusedError, Served


@pytest.mark.slow
def test_the_worst_car_is_run_with_its_numbers_and_its_controller(service: Served) -> None:
    client = Client(service.url)
    asked = client.add_campaign(CampaignWanted(text=CAMPAIGN, files={"short.yaml": PLAN}))
    until_s = time.monotonic() + 120
    while client.campaign(asked.id).state not in CAMPAIGN_OVER:
        assert time.monotonic() < until_s
        time.sleep(0.2)
    findings = client.campaign_findings(asked.id)
    worst = min((one for of in findings.controllers for one in of.worst), key=lambda one: one.margin)
    address = f"/api/v1/campaigns/{asked.id}/simulations"
    files = service.ask("GET", f"{address}/{worst.simulation}")
    name = files["name"]
    assert name == f"campaign-{asked.id}-car-{worst.simulation}"
    service.ask("PUT", f"/api/v1/models/{files['model_name']}", files["model"])
    service.ask("PUT", f"/api/v1/bench-files/{name}", files["bench"])
    service.ask("PUT", f"/api/v1/bench-files/{name}/service")
    service.ask("PUT", f"/api/v1/controllers/{name}", files["controller"])
    service.ask("PUT", f"/api/v1/plans/{name}", files["plan"])
    run = service.ask("POST", "/api/v1/runs", {"plan": name, "bench": name})
    service.over(run["id"])
    result = json.loads((service.data / f"runs/{run['id']:06d}/result.json").read_text("utf-8"))
    found = next(one for one in result["criteria"] if one["id"] == worst.binding)
    limit = found["upper"] if found["upper"] is not None else found["lower"]
    margin = (limit - found["value"]) / abs(limit) * (1 if found["upper"] is not None else -1)
    assert margin == pytest.approx(worst.margin, abs=0.03)
    with pytest.raises(RefusedError, match="there is no simulation 16"):
        service.ask("GET", f"{address}/16")
