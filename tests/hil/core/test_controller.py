"""What the values of a controller file may be, and what its lead does."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from hil.core.controller import LARGEST_ORDER, Lead, controller_from_toml, controller_to_toml, load_controller
from hil.core.errors import BadInputError

LIBRARY = Path(__file__).parents[3] / "test_plans/library/controllers"
PHASE, GAIN = (load_controller(LIBRARY / f"{name}_stabilization.toml") for name in ("phase", "gain"))


def changed(key: str, value: Any) -> str:
    data: dict[str, Any] = tomllib.loads(controller_to_toml(GAIN if "notch" in key else PHASE))
    *tables, last = key.split(".")
    table = data
    for name in tables:
        table = table[name]
    table[last] = value
    return tomli_w.dumps(data)


@pytest.mark.parametrize(
    ("key", "refused", "taken"),
    [
        ("sample_time_s", (0.0, -1e-3), (1e-4,)),
        ("torque_limit_nm", (0.0, -0.5), (0.5,)),
        ("dfc.integral_gain", (-0.5,), (0.0, 0.5)),
        ("dfc.feedforward_time_constant_s", (0.0, -0.5), (0.5,)),
        ("dfc.wheel_radius_m", (0.0, -0.5), (0.5,)),
        ("dfc.slip_floor_m_s", (0.0, -0.5), (0.5,)),
        ("dfc.slip_limit", (-0.5,), (0.0, 0.5)),
        ("wsc.proportional_gain", (-0.5,), (0.0, 0.5)),
        ("wsc.integral_gain", (-0.5,), (0.0, 0.5)),
        ("wsc.filter_time_constant_s", (0.0, -0.5), (0.5,)),
        ("wsc.lead.alpha", (0.0, -0.5, 1.5), (0.5, 1.0)),
        ("wsc.lead.time_constant_s", (0.0, -0.5), (0.5,)),
        ("wsc.notch.frequency_hz", (0.0, -0.5), (0.5,)),
        ("wsc.notch.width", (0.0, -0.5), (0.5,)),
        ("wsc.notch.depth", (-0.5,), (0.0, 0.5)),
        ("dfo.time_constant_s", (0.0, -0.5), (0.5,)),
        ("dfo.gear_ratio", (0.0, -0.5), (0.5,)),
        ("dfo.wheel_inertia_kg_m2", (0.0, -0.5), (0.5,)),
        ("plant.denominator", ([1.0], [1.0] * (LARGEST_ORDER + 2)), ([1.0] * (LARGEST_ORDER + 1),)),
        ("plant.motor_speed", ([], [1.0] * (LARGEST_ORDER + 2)), ([1.0], [1.0] * (LARGEST_ORDER + 1))),
        ("plant.wheel_speed", ([], [1.0] * (LARGEST_ORDER + 2)), ([1.0], [1.0] * (LARGEST_ORDER + 1))),
        ("plant.shaft_torque", ([], [1.0] * (LARGEST_ORDER + 2)), ([1.0], [1.0] * (LARGEST_ORDER + 1))),
        ("name", ("",), ("x",)),
    ],
)
def test_values_have_limits(key: str, refused: tuple[Any, ...], taken: tuple[Any, ...]) -> None:
    for value in refused:
        with pytest.raises(BadInputError, match=key):
            controller_from_toml(changed(key, value), "here")
    for value in taken:
        controller_from_toml(changed(key, value), "here")


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
