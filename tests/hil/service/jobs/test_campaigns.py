"""Campaigns of the service: given, watched, cancelled and gone on with, also after the service was killed."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pandas as pd
import pytest

from hil.api_schemas.campaign import CAMPAIGN_OVER, CampaignData, CampaignWanted
from hil.client import Client, RefusedError
from tests.hil.analysis.tuning.trials import PLAN
from tests.hil.campaign.short import CAMPAIGN
from tests.hil.service.served import Served, served

#: Some seconds of one processor, in eight part files or more.
LONG = """
name: long
plan: short.yaml
draws: 1000
seed: 3
tolerance: {tyre_stiffness: 0.2, sensor_noise: 1}
"""
WANTED = CampaignWanted(text=CAMPAIGN + "pass_share: 0.5\n", files={"short.yaml": PLAN})


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("campaigns")
    with served(folder / "data", "--workers", "0", state=folder / "state") as service:
        yield service


def until(
    client: Client, campaign: int, wanted: Callable[[CampaignData], bool], within_s: float = 120.0
) -> CampaignData:
    until_s = time.monotonic() + within_s
    while not wanted(found := client.campaign(campaign)):
        assert time.monotonic() < until_s, found
        time.sleep(0.2)
    return found


def over(client: Client, campaign: int) -> CampaignData:
    return until(client, campaign, lambda found: found.state in CAMPAIGN_OVER)


@pytest.mark.slow
def test_a_campaign_is_given_carried_out_and_its_table_fetched(there: Served, tmp_path: Path) -> None:
    client = Client(there.url)
    asked = client.add_campaign(WANTED)
    assert (asked.name, asked.plan, asked.model, asked.simulations, asked.draws) == (
        "short_campaign", "short", "three_inertia", 16, 2,
    )  # fmt: skip
    found = over(client, asked.id)
    assert (found.state, found.done, found.passed) == ("ended", 16, True), found.reason
    assert {"campaign.json", "report.html", "report.pdf", "simulations.parquet"} < set(found.files)
    client.download_of_campaign(found.id, "simulations.parquet", tmp_path / "table.parquet")
    table = pd.read_parquet(tmp_path / "table.parquet")
    assert list(table["simulation"]) == list(range(16))
    client.download_of_campaign(found.id, "campaign.json", tmp_path / "campaign.json")
    told = json.loads((tmp_path / "campaign.json").read_text())
    shares = {one["controller"]: one["share"] for one in told["controllers"]}
    assert {
        one.controller: one.model_dump(mode="json", exclude={"controller"}) for one in found.controllers
    } == shares
    assert ("local", "campaign") in {(one.who, one.action) for one in client.audit()}
    with pytest.raises(RefusedError, match="is finished"):
        client.cancel_campaign(found.id)
    with pytest.raises(RefusedError, match="is ended"):
        client.resume_campaign(found.id)
    client.remove_campaign(found.id)
    with pytest.raises(RefusedError, match="there is no campaign"):
        client.campaign(found.id)
    assert list((there.data / f"campaigns/{found.id:06d}").iterdir()) == []
    removed = next(one for one in client.audit() if one.action == "campaign removed")
    assert removed.detail == "short_campaign: 16 of 16 simulations"


@pytest.mark.slow
def test_what_the_service_has_is_found_by_name_and_kept_as_it_was(there: Served) -> None:
    client = Client(there.url)
    client.give_plan("short", PLAN)
    text = (
        "name: own\nplan: short\nbench: sim\nmodel: three_inertia\nvary: {model.tyre_stiffness: [8e3, 9e3]}\n"
    )
    asked = client.add_campaign(CampaignWanted(text=text))
    client.give_plan("short", PLAN + "# another\n")
    found = over(client, asked.id)
    assert (found.state, found.done, found.draws) == ("ended", 2, 0), found.reason
    assert found.controllers[0].interval is None  # a grid is no sample
    assert "robustness" in {one.name for one in client.campaign_examples()}


@pytest.mark.parametrize(
    ("text", "files", "said"),
    [
        ("name: own\nplan: none\n", {}, "there is no plan 'none'"),
        ("name: own\nplan: none.yaml\n", {}, "there is no plan 'none.yaml'"),
        ("name: own\nplan: ../../secret.yaml\n", {}, "is not a plain file name"),
        ("name: own\nplan: acceptance\nmodel: /etc/passwd\n", {}, "is not a plain file name"),
        ("name: own\nplan: acceptance\nbench: /etc/passwd\n", {}, "there is no bench"),
        ("name: own\nplan: acceptance\ncontrollers: [../a.toml]\n", {}, "is not a plain file name"),
        (
            "name: own\nplan: mine.yaml\n",
            {"mine.yaml": PLAN.replace("phase_stab", "/etc/phase_stab")},
            "loads",
        ),
        ("name: own\nplans: acceptance\n", {}, "unknown key 'plans'"),
        ("name: own\nplan: acceptance\nvary: {model.none: [1]}\n", {}, "none"),
    ],
)
def test_what_cannot_be_a_campaign_is_said_and_leaves_nothing(
    there: Served, text: str, files: dict[str, str], said: str
) -> None:
    client, before = Client(there.url), len(list((there.data / "campaigns").iterdir()))
    with pytest.raises(RefusedError, match=said) as refused:
        client.add_campaign(CampaignWanted(text=text, files=files))
    assert refused.value.status == 422
    assert str(there.data) not in str(refused.value)
    assert len(list((there.data / "campaigns").iterdir())) == before


@pytest.mark.slow
def test_a_cancelled_campaign_keeps_what_was_done_and_goes_on(there: Served) -> None:
    client = Client(there.url)
    first = client.add_campaign(CampaignWanted(text=LONG, files={"short.yaml": PLAN}))
    second = client.add_campaign(WANTED)
    started = until(client, first.id, lambda found: found.done > 0)
    assert (started.state, client.campaign(second.id).state) == ("running", "waiting")
    assert started.controllers[0].of == started.done
    with pytest.raises(RefusedError, match=f"campaign {first.id} is running"):
        client.remove_campaign(first.id)
    assert client.cancel_campaign(second.id).state == "cancelled"
    assert client.cancel_campaign(first.id).state == "stopping"
    kept = over(client, first.id)
    assert kept.state == "cancelled"
    assert 0 < kept.done < kept.simulations
    rows = len(pd.read_parquet(io.BytesIO(there.get(f"/campaigns/{first.id}/files/simulations.parquet"))))
    assert rows == kept.done
    client.resume_campaign(first.id)
    found = over(client, first.id)
    assert (found.state, found.done) == ("ended", 1000)


@pytest.mark.slow
def test_a_campaign_survives_its_service(tmp_path: Path) -> None:
    """On two workers of dask.distributed, of which none is left by the kill."""
    data = tmp_path / "data"
    with served(data, "--workers", "2", state=tmp_path / "state") as one:
        client = Client(one.url)
        asked = client.add_campaign(CampaignWanted(text=LONG, files={"short.yaml": PLAN}))
        started = until(client, asked.id, lambda found: found.done > 0)
        one.process.kill()
        one.process.wait()
    parts = data / f"campaigns/{asked.id:06d}/results/simulations"
    kept = {path: path.stat().st_mtime_ns for path in parts.iterdir()}
    with served(data, "--workers", "2", state=tmp_path / "state") as one:
        found = over(Client(one.url), asked.id)
        assert (found.state, found.done) == ("ended", found.simulations), found.reason
    assert len(kept) > 0
    assert started.done < found.simulations
    assert {path: path.stat().st_mtime_ns for path in kept} == kept  # nothing was done twice
    table = pd.read_parquet(parts.parent / "simulations.parquet")
    assert list(table["simulation"]) == list(range(found.simulations))
