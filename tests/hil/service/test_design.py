"""Models, controllers, drafts and copies of plans, over the API of the real service."""

from __future__ import annotations

import pytest

from hil.analysis.control_design import DesignSpec, design
from hil.api_schemas.api import RunWanted
from hil.api_schemas.design import DraftWanted, PlanCopyWanted
from hil.client import Client, RefusedError
from hil.core.controller import controller_from_toml
from hil.core.model import load_model
from hil.core.recording import read_recording
from hil.engine.bench.bench_file import shipped
from tests.hil.service.served import SHORT, Served
from tests.hil.service.served import RefusedError as AnswerError


@pytest.fixture
def client(service: Served) -> Client:
    return Client(service.url)


@pytest.mark.slow
def test_a_draft_is_what_the_design_says_of_the_model_itself(client: Client) -> None:
    found = client.draft(DraftWanted(model="three_inertia", lead_deg=30))
    whole = design(load_model(shipped("three_inertia.toml")), DesignSpec(lead_deg=30))
    margins = whole.loop("phase").margins
    assert found.margins.gain_margin_db == pytest.approx(margins.gain_margin_db, rel=1e-3)
    assert found.margins.sensitivity_peak == pytest.approx(margins.sensitivity_peak, rel=1e-3)
    assert found.resonance_hz == pytest.approx(whole.plant.resonance_hz)
    assert [one.speed_km_h for one in found.steps] == [0.0, 20.0]
    assert all(one.peak_shaft_torque_nm > 300 for one in found.steps)  # type: ignore[operator]
    assert {len(found.time_s)} == {len(one.shaft_torque_nm) for one in found.steps}
    pi, chosen = found.loops
    assert max(one or 0.0 for one in pi.sensitivity) > max(one or 0.0 for one in chosen.sensitivity)


@pytest.mark.parametrize("model", ["paper_car_axle", "paper_functions"])
def test_every_shipped_model_is_drafted_for_with_lead_and_notch(client: Client, model: str) -> None:
    lead = client.draft(DraftWanted(model=model))
    notch = client.draft(DraftWanted(model=model, stabilisation="gain"))
    assert lead.margins.stable
    assert notch.margins.stable
    assert lead.steps_why_not == notch.steps_why_not == ""
    assert lead.loops[1].real != notch.loops[1].real


def test_an_unstable_loop_is_drawn_and_said_and_gives_no_controller(client: Client) -> None:
    wanted = DraftWanted(model="three_inertia", pole_rad_s=60.0, lead_deg=5.0)
    found = client.draft(wanted)
    assert "outside the unit circle" in found.unstable
    assert found.loops
    with pytest.raises(RefusedError, match="unstable"):
        client.design(wanted)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"lead_deg": 90.0}, "at most 85 degrees"),
        ({"lead_hz": 0.0}, "from 0.01 to below 500 Hz"),
        ({"stabilisation": "gain", "notch_depth": 2.0}, "from 0"),
        ({"model": "none"}, "there is no model 'none'"),
    ],
)
def test_what_cannot_be_drafted_is_said(client: Client, wrong: dict[str, object], said: str) -> None:
    with pytest.raises(RefusedError) as refused:
        client.draft(DraftWanted.model_validate({"model": "three_inertia", **wrong}))
    assert said in str(refused.value)


@pytest.mark.slow
def test_a_saved_controller_runs_in_a_copy_of_a_plan(client: Client, service: Served) -> None:
    found = client.design(DraftWanted(model="three_inertia", lead_deg=30, name="softer"))
    assert controller_from_toml(found.controller, "it").name == "softer"
    assert found.stable_share == 1.0
    client.give_controller("softer", found.controller)
    client.give_plan("base", SHORT.replace("name: short", "name: base\ntitle: A base"))
    wanted = PlanCopyWanted(name="base-softer", controllers={"phase_stabilization.toml": "softer"})
    assert client.copy_plan("base", wanted).title == "A base, base-softer"
    assert client.forecast("base-softer", "sim").fits
    run = client.queue(RunWanted(plan="base-softer", bench="sim"))
    *_, last = client.progress(run.id)
    assert last.verdict == "pass"
    recording = read_recording(service.data / f"runs/{run.id:06d}/recording.mcap")
    assert recording.attachments["controller/softer.toml"].decode() == found.controller
    with pytest.raises(AnswerError, match="is loaded by the plan 'base-softer'"):
        service.ask("DELETE", "/api/v1/controllers/softer")
    service.ask("DELETE", "/api/v1/plans/base-softer")
    service.ask("DELETE", "/api/v1/controllers/softer")
    assert "softer" not in {one.name for one in client.controllers()}


def test_a_name_stands_for_one_content(client: Client, service: Served) -> None:
    text = shipped("three_inertia.toml").read_text("utf-8")
    assert client.give_model("mine", text).kind == "three_inertia"
    client.give_model("mine", text)
    with pytest.raises(RefusedError, match="is already used for other content"):
        client.give_model("mine", text + "\n# other\n")
    with pytest.raises(RefusedError, match="is the name of a built-in one"):
        client.give_model("three_inertia", text)
    with pytest.raises(RefusedError, match="unknown key"):
        client.give_model("other", "nonsense = 1\n")
    assert "other" not in {one.name for one in client.models()}
    assert service.ask("DELETE", "/api/v1/models/mine") == b""


def test_a_copy_is_of_what_there_is(client: Client) -> None:
    with pytest.raises(RefusedError, match="there is no controller 'none'"):
        client.copy_plan("acceptance", PlanCopyWanted(name="x", controllers={"a.toml": "none"}))
    wanted = {"nothing.toml": "phase_stabilization"}
    with pytest.raises(RefusedError, match="loads no controller 'nothing.toml'"):
        client.copy_plan("acceptance", PlanCopyWanted(name="x", controllers=wanted))
