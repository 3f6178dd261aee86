"""What the values of a controller file may be, and what its lead does."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from hil.core.controller import (
    LARGEST_ORDER,
    Lead,
    controller_from_toml,
    controller_schema,
    controller_to_toml,
    load_controller,
)
from hil.core.errors import BadInputError

LIBRARY = Path(__file__).parents[4] / "test_plans/library/controllers"
PHASE, GAIN = (load_controller(LIBRARY / f"{name}_stabilization.toml") for name in ("phase", "gain"))
CROSSING = load_controller(LIBRARY / "play_crossing.toml")
TABLES = {
    **CROSSING.model_dump(exclude_none=True),
    "request": {"rise_nm_s": 5000.0, "fall_nm_s": 9000.0, "zero_band_nm": 30.0, "zero_gradient_nm_s": 900.0},
    "slip": {"allowed": 0.1},
    "schedule": {"speed_m_s": [1.0, 10.0], "wsc_factor": [1.0, 0.5], "dfc_factor": [1.0, 2.0]},
}


def changed(key: str, value: Any) -> str:
    plain: dict[str, Any] = tomllib.loads(controller_to_toml(GAIN if "notch" in key else PHASE))
    data = TABLES if key.partition(".")[0] in ("request", "slip", "play", "schedule") else plain
    data = copy.deepcopy(data)
    *tables, last = key.split(".")
    table = data
    for name in tables:
        table = table[name]
    table[last] = value
    return tomli_w.dumps(data)


@pytest.mark.parametrize(
    ("key", "refused", "taken"),
    [
        ("sample_time_s", (0.0, -1e-3, 9e-5, 0.011, "0.001"), (1e-4, 1e-2)),
        ("torque_limit_nm", (0.0, -0.5, 301, "150", True), (0.5, 300)),
        ("dfc.integral_gain", (-0.5, 1.1e6, "0.001", False), (0.0, 0.5)),
        ("dfc.feedforward_time_constant_s", (0.0, -0.5, 9e-6, 1.1e4), (0.5,)),
        ("dfc.wheel_radius_m", (0.0, -0.5), (0.5,)),
        ("dfc.slip_floor_m_s", (0.0, -0.5), (0.5,)),
        ("dfc.slip_limit", (-0.5,), (0.0, 0.5)),
        ("wsc.proportional_gain", (-0.5,), (0.0, 0.5)),
        ("wsc.integral_gain", (-0.5,), (0.0, 0.5)),
        ("wsc.filter_time_constant_s", (0.0, -0.5, 9e-6, 1.1e4), (0.5,)),
        ("wsc.lead.alpha", (0.0, -0.5, 1.5, 1e-12), (0.5, 1.0)),
        ("wsc.lead.time_constant_s", (0.0, -0.5, 1e-9, 1e-4), (0.5,)),
        ("wsc.notch.frequency_hz", (0.0, -0.5, 1e-9, 500.0), (0.5, 499.0)),
        ("wsc.notch.width", (0.0, -0.5, 1e-9, 1e9), (0.5,)),
        ("wsc.notch.depth", (-0.5, 11.0), (0.0, 0.5)),
        ("dfo.time_constant_s", (0.0, -0.5, 9e-6, 1.1e4), (0.5,)),
        ("dfo.gear_ratio", (0.0, -0.5, 1e9), (0.5,)),
        ("dfo.wheel_inertia_kg_m2", (0.0, -0.5), (0.5,)),
        ("plant.denominator", ([1.0], [0.0, 0.0], [0.0, 1.0], [1.0, "2"], [1.0, 1e70]), ([1.0] * 5,)),
        ("plant.motor_speed", ([], [0.0], [1.0] * (LARGEST_ORDER + 2), [1.0] * 6), ([1.0], [1.0] * 5)),
        ("plant.wheel_speed", ([], [1.0] * (LARGEST_ORDER + 2), [1.0]), ([1.0] * (LARGEST_ORDER + 1),)),
        ("plant.shaft_torque", ([], [1.0] * (LARGEST_ORDER + 2), [0.0, 0.0]), ([1.0] * (LARGEST_ORDER + 1),)),
        ("name", ("",), ("x",)),
        ("request.rise_nm_s", (-1.0, 1.1e7, "1"), (0.0, 1e4)),
        ("request.zero_band_nm", (-1.0, 1.1e4), (10.0,)),
        ("slip.allowed", (0.0, -0.1, 1.1), (0.05,)),
        ("slip.recovery_nm_s", (0.0, -0.1), (500.0,)),
        ("play.half_gap_rad", (-1e-3, 1.1), (0.004, 0.03)),
        ("play.landing_margin_rad", (-1e-3, 1.1), (0.0, 0.04)),
        ("play.crossing_speed_rad_s", (0.0, -1.0, 1.1e3), (1.5,)),
        ("play.crossing_torque_nm", (0.0, 301.0), (20.0,)),
        ("play.follow_gradient_nm_s", (0.0,), (3000.0,)),
        ("play.follow_time_constant_s", (0.0, 1e-6), (0.05,)),
        ("play.shaft_stiffness_nm_rad", (0.0, -1.0, 0.5, 1e9), (5000.0,)),
        ("play.shaft_damping_nms_rad", (-1.0, 1e9), (0.0, 200.0)),
        ("play.tyre_stiffness_nm_rad", (0.0, 1e9), (5000.0,)),
        ("play.tyre_damping_nms_rad", (-1.0, 1e9), (0.0, 500.0)),
        ("play.correction", (-0.1, 1.1), (0.0, 1.0)),
        ("play.dead_time_s", (-1e-3, 0.065, 0.7), (0.0, 0.064)),
        ("schedule.speed_m_s", ([], [2.0, 1.0], [1.0, 1.0], [1.0], [-1.0, 2.0]), ([0.0, 30.0],)),
        ("schedule.wsc_factor", ([1.0], [1.0, -1.0], [1.0, "2"], [1.0] * 7), ([0.0, 2.0],)),
    ],
)
def test_values_have_limits(key: str, refused: tuple[Any, ...], taken: tuple[Any, ...]) -> None:
    named = "schedule" if key.startswith("schedule") else key  # what contradicts another names its table
    for value in refused:
        with pytest.raises(BadInputError, match=named):
            controller_from_toml(changed(key, value), "here")
    for value in taken:
        controller_from_toml(changed(key, value), "here")


@pytest.mark.parametrize(
    ("written", "instead", "said"),
    [
        ("alpha = ", "alpha = 1e-12", "it lies from 0.0019 to 1: (6) gives 0.0019 for 85 degrees"),
        ("sample_time_s = ", "sample_time_s = 0.05", "it lies from 0.0001 to 0.01: the range of the RMCU"),
        ("wheel_speed = ", "wheel_speed = [1.0]", "the filter (17) would be improper"),
        (
            "time_constant_s = 0.0078",
            "time_constant_s = 1e-4",
            "3124 Hz: it lies below 500 Hz, half the",
        ),
    ],
)
def test_a_refusal_names_file_line_key_bound_and_reason(written: str, instead: str, said: str) -> None:
    lines = (LIBRARY / "phase_stabilization.toml").read_text("utf-8").splitlines()
    (place,) = (number for number, line in enumerate(lines) if line.startswith(written))
    lines[place] = instead
    with pytest.raises(BadInputError) as refused:
        controller_from_toml("\n".join(lines), "mine.toml")
    assert refused.value.where == f"mine.toml, line {place + 1}"
    assert instead.partition(" =")[0] in refused.value.what
    assert said in refused.value.what


def test_tables_that_are_off_are_not_written() -> None:
    text = controller_to_toml(PHASE)
    assert not any(f"[{table}]" in text for table in ("request", "slip", "play", "schedule"))
    assert controller_from_toml(tomli_w.dumps(TABLES), "here").schedule is not None


def test_a_band_around_zero_has_a_gradient() -> None:
    data = copy.deepcopy(TABLES)
    data["request"] = {"zero_band_nm": 30.0}
    with pytest.raises(BadInputError, match="belong together"):
        controller_from_toml(tomli_w.dumps(data), "here")


def test_the_schema_has_the_bounds() -> None:
    assert controller_schema()["properties"]["sample_time_s"]["maximum"] == 1e-2


def test_a_controller_has_a_lead_or_a_notch() -> None:
    assert (PHASE.stabilization, GAIN.stabilization) == ("phase", "gain")
    both = PHASE.model_dump() | {"wsc": PHASE.wsc.model_dump() | {"notch": GAIN.wsc.model_dump()["notch"]}}
    with pytest.raises(ValueError, match="not both"):
        type(PHASE).model_validate(both)
    neither = PHASE.model_copy(update={"wsc": PHASE.wsc.model_copy(update={"lead": None})})
    assert neither.stabilization == "none"


@pytest.mark.parametrize("normalisation", ["dc", "centre", "high_frequency"])
def test_the_leads_gain_is_one_where_its_name_says(normalisation: Any) -> None:
    lead = Lead(alpha=0.16, time_constant_s=0.05, normalisation=normalisation)
    omega = {"dc": 0.0, "centre": 1 / (0.05 * 0.16**0.5), "high_frequency": 1e9}[normalisation]
    s = 1j * omega
    response = lead.gain * (lead.time_constant_s * s + 1) / (lead.alpha * lead.time_constant_s * s + 1)
    assert abs(response) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("points", "words"),
    [(0, "[]: must have at least 1 entry, not none"), (7, "must have at most 6 entries, not 7")],
)
def test_a_table_over_speed_has_one_to_six_points(points: int, words: str) -> None:
    data = copy.deepcopy(TABLES)
    data["schedule"] = {
        "speed_m_s": [float(n) for n in range(points)],
        "wsc_factor": [1.0] * points,
    }
    with pytest.raises(BadInputError) as refused:
        controller_from_toml(tomli_w.dumps(data), "here")
    text = str(refused.value)
    assert words in text
    assert "tuple" not in text
    assert "schedule.speed_m_s" in text


def test_a_margin_wider_than_the_gap_is_refused() -> None:
    with pytest.raises(BadInputError, match=r"landing_margin_rad = 0.05 is wider than the gap .* = 0.04"):
        controller_from_toml(changed("play.landing_margin_rad", 0.05), "here")
