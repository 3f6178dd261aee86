"""Models, controllers, bench files as they are written: mistakes by line, what follows, no file elsewhere."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hil.core.errors import BadInputError
from hil.engine.bench.bench_file import shipped
from hil.service.files.plan_checks import mistakes_of
from hil.service.worker_pool.file_checking import file
from test_plans import library_controllers
from tests.hil.service.served import SHORT, RefusedError, Served, served

MODEL, BENCH = (shipped(f"{name}.toml").read_text("utf-8") for name in ("three_inertia", "sim"))
CONTROLLER = library_controllers()["phase_stabilization"].read_text("utf-8")
MODELS = {"three_inertia": str(shipped("three_inertia.toml"))}


def figures(found: dict[str, Any]) -> dict[str, Any]:
    return {
        one["name"]: one["value"] if one["value"] is not None else one["text"] for one in found["figures"]
    }


def test_what_follows_from_a_two_inertia_model_is_that_of_the_closed_form() -> None:
    """Motor J_m, vehicle J_v behind gear N and shaft k, d: free oscillation of two inertias, wheel side."""
    motor, gear, stiffness, damping, vehicle = 0.02, 8.0, 6000.0, 20.0, 300.0
    text = (
        f'kind = "two_inertia"\n[parameters]\nmotor_inertia = {motor}\ngear_ratio = {gear}\n'
        f"shaft_stiffness = {stiffness}\nshaft_damping = {damping}\nvehicle_inertia = {vehicle}\n"
        "torque_delay = 0.008\n"
    )
    found = figures(file("model", "a", text, {}, ""))
    together = 1.0 / (1.0 / (motor * gear**2) + 1.0 / vehicle)
    natural_rad_s = math.sqrt(stiffness / together)
    assert found["resonance"] == pytest.approx(natural_rad_s / (2 * math.pi), rel=1e-6)
    ratio = damping / (2 * math.sqrt(stiffness * together))
    assert found["damping ratio of the resonance"] == pytest.approx(ratio, rel=1e-6)
    antiresonance_hz = math.sqrt(stiffness / vehicle) / (2 * math.pi)
    assert found["antiresonance of the motor speed"] == pytest.approx(antiresonance_hz, rel=1e-6)
    assert found["dead time"] == pytest.approx(8.0)
    assert found["inertia seen by the motor"] == pytest.approx(motor + vehicle / gear**2, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (MODEL + '\n[[effects]]\nid = "backlash"\nhalf_gap_rad = -1\n', "half_gap_rad = -1"),
        (MODEL + '\n[[effects]]\nid = "backlash"\n', "[[effects]]"),
        (MODEL.replace("torque_delay = 0.008", "torque_delay = -1"), "torque_delay = -1"),
        (MODEL.replace("[parameters]", "[parameters"), "[parameters"),
    ],
)
def test_a_single_mistake_stands_at_its_line_too(text: str, line: str) -> None:
    with pytest.raises(BadInputError) as refused:
        file("model", "a", text, {}, "")
    (mistake,) = mistakes_of(refused.value)
    assert mistake.line is not None, refused.value
    assert text.splitlines()[mistake.line - 1].startswith(line)


def test_a_model_that_no_controller_can_be_designed_for_says_why() -> None:
    text = (
        'kind = "rigid"\n[parameters]\nmotor_inertia = 0.02\ngear_ratio = 8\nvehicle_inertia = 300\n'
        "viscous_drag = 1\ntorque_delay = 0.008\n"
    )
    found = file("model", "a", text, {}, "")
    assert "no controller can be designed for it" in found["notes"][0]
    assert figures(found)["kind"] == "rigid"


def test_a_bench_file_is_checked_without_a_bus_and_names_no_file_elsewhere(tmp_path: Path) -> None:
    found = figures(file("bench", "mine", BENCH, MODELS, ""))
    assert (found["kind"], found["limit of motor_speed_rad_s"]) == ("simulated", 700.0)
    hidden = tmp_path / "secret.dbc"
    hidden.write_text("not for everybody", "utf-8")
    for text in (BENCH.replace("rmcu.dbc", str(hidden)), BENCH.replace("rmcu.dbc", "../secret.dbc")):
        with pytest.raises(BadInputError, match="is not a name alone") as refused:
            file("bench", "mine", text, MODELS, "")
        assert "not for everybody" not in str(refused.value)
    for model in ("../three_inertia.toml", str(hidden)):
        with pytest.raises(BadInputError, match="simulation.model"):
            file("bench", "mine", BENCH.replace("three_inertia.toml", model), MODELS, "")
    with pytest.raises(BadInputError, match="no such file") as missing:
        file("bench", "mine", BENCH.replace("three_inertia.toml", "none.toml"), MODELS, "")
    assert "/tmp" not in str(missing.value)


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("file-checks")
    with served(folder / "data", "--rate", "1000", state=folder / "state") as service:
        yield service


@pytest.mark.slow
def test_mistakes_stand_at_their_lines_and_margins_follow_from_a_controller(there: Served) -> None:
    wanted = {"kind": "controller", "name": "mine", "text": CONTROLLER, "model": "three_inertia"}
    found = there.post("/file-checks", wanted)
    assert found["mistakes"] == []
    assert figures(found)["loop"] == "stable"
    assert figures(found)["gain margin"] == pytest.approx(10.9, abs=0.1)  # as hil check says it
    wrong = MODEL.replace("gear_ratio", "gear_ration").replace("torque_delay = 0.008", "torque_delay = -1")
    found = there.post("/file-checks", {"kind": "model", "name": "mine", "text": wrong})
    lines = wrong.splitlines()
    marked = {lines[one["line"] - 1].split(" ")[0] for one in found["mistakes"] if one["line"]}
    assert {"gear_ration", "torque_delay"} <= marked
    with pytest.raises(RefusedError, match="there is no model 'none'"):
        there.post("/file-checks", {**wanted, "model": "none"})


@pytest.mark.slow
def test_a_bench_file_is_given_made_a_new_version_of_and_removed(there: Served) -> None:
    assert {"sim", "rear_axle_socketcan"} <= {one["name"] for one in there.get("/bench-files")}
    mine = BENCH.replace('name = "sim"', 'name = "mine"').replace('"sim/', '"mine/')
    given = there.ask("PUT", "/api/v1/bench-files/mine", mine)
    assert given == {
        "name": "mine",
        "title": "Simulated rear axle bench",
        "simulated": True,
        "built_in": False,
        "served": False,
    }
    with pytest.raises(RefusedError, match="already used for other content"):
        there.ask("PUT", "/api/v1/bench-files/mine", mine + "# changed\n")
    with pytest.raises(RefusedError, match="built-in"):
        there.ask("PUT", "/api/v1/bench-files/sim", mine)
    with pytest.raises(RefusedError, match="not a name alone"):
        there.ask("PUT", "/api/v1/bench-files/other", mine.replace("rmcu.dbc", "/etc/passwd"))
    there.ask("PUT", "/api/v1/bench-files/mine_2?based_on=mine", mine.replace("mine", "mine_2"))
    there.ask("DELETE", "/api/v1/bench-files/mine")
    found = there.get("/versions/bench/mine_2")
    assert [(one["number"], one["name"], one["given_by"]) for one in found] == [
        (2, "mine_2", "local"),
        (1, "mine", "local"),
    ]
    assert there.get("/versions/bench/mine_2/1/text").decode() == mine


@pytest.mark.slow
def test_a_given_simulated_bench_is_served_and_is_there_after_a_kill(tmp_path: Path) -> None:
    mine = BENCH.replace('name = "sim"', 'name = "mine"').replace('"sim/', '"mine/')
    mine = mine.replace("three_inertia.toml", "soft.toml")
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        service.give("short", SHORT)
        soft = MODEL.replace("6089.0", "5000.0")
        service.ask("PUT", "/api/v1/models/soft", soft)
        service.ask("PUT", "/api/v1/bench-files/mine", mine)
        hardware = shipped("rear_axle_socketcan.toml").read_text("utf-8")
        hardware = hardware.replace('name = "rear_axle_socketcan"', 'name = "hard"')
        service.ask("PUT", "/api/v1/bench-files/hard", hardware)
        with pytest.raises(RefusedError, match="is a bench on hardware"):
            service.ask("PUT", "/api/v1/bench-files/hard/service")
        assert service.ask("PUT", "/api/v1/bench-files/mine/service")["served"]
        with pytest.raises(RefusedError, match="is a bench of this service"):
            service.ask("DELETE", "/api/v1/bench-files/mine")
        run = service.queue("short", bench="mine")
        assert service.over(run)["state"] == "ended"
        model = service.get(f"/comparisons?first={run}&other={run}")
        assert model["plan"] == "short"
        service.post("/benches/mine/emergency-stop")
        assert service.get("/benches/mine")["state"] == "emergency_stop"
        service.process.kill()
        service.process.wait()
    with served(tmp_path / "data", "--rate", "1000", state=tmp_path / "state") as service:
        assert service.get("/benches/mine")["state"] == "emergency_stop"  # latched beyond its service
        service.post("/benches/mine/reset")
        waiting = service.queue("short", bench="mine")
        with pytest.raises(RefusedError, match=rf"stays in service: run {waiting} \(short, of local\)"):
            service.ask("DELETE", "/api/v1/bench-files/mine/service")
        service.over(waiting)
        now = datetime.datetime.now(datetime.UTC).replace(microsecond=0)
        span = {"begins": now.isoformat(), "ends": (now + datetime.timedelta(hours=1)).isoformat()}
        held = service.post("/benches/mine/reservations", {**span, "reason": "endurance"})
        with pytest.raises(RefusedError, match="local has reserved it from .* UTC: endurance"):
            service.ask("DELETE", "/api/v1/bench-files/mine/service")
        assert "mine" in {one["name"] for one in service.get("/benches")}
        service.ask("DELETE", f"/api/v1/benches/mine/reservations/{held['id']}")
        service.ask("PUT", "/api/v1/benches/mine/lease", {"for_s": 60})
        with pytest.raises(RefusedError, match="local has it until"):
            service.ask("DELETE", "/api/v1/bench-files/mine/service")
        service.ask("DELETE", "/api/v1/benches/mine/lease")
        assert not service.ask("DELETE", "/api/v1/bench-files/mine/service")["served"]
        assert "mine" not in {one["name"] for one in service.get("/benches")}
        assert service.get(f"/runs/{run}")["state"] == "ended"
