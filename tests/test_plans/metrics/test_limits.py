"""What values a criterion's options may have: the first that is refused, and one just inside."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from hil.core.recording import Recording
from hil.core.result import Segment
from test_plans.metrics import (
    BandEnergy,
    BandEnergyMotorSpeed,
    Metric,
    OvershootPercent,
    Peak,
    SettlingTime,
)

T = {"channel": "shaft_torque_nm"}
BAND = T | {"from_hz": 0.0, "to_hz": 1.0}


@pytest.mark.parametrize(
    ("metric", "base", "option", "refused", "taken"),
    [
        (Peak, T, "from_s", (-0.5, -1e-9), (0.0, 0.5)),
        (Peak, T, "to_s", (-0.5, 0.0), (0.5, 1e-9)),
        (BandEnergy, BAND, "from_hz", (-0.5,), (0.0, 0.5)),
        (BandEnergy, BAND, "to_hz", (-0.5, 0.0), (0.5,)),
        (BandEnergyMotorSpeed, {}, "from_s", (-0.5,), (0.0, 0.5)),
        (BandEnergyMotorSpeed, {"from_s": 0.0}, "to_s", (-0.5, 0.0), (0.5,)),
        (BandEnergyMotorSpeed, {}, "from_hz", (-0.5,), (0.0, 0.5)),
        (BandEnergyMotorSpeed, {"from_hz": 0.0}, "to_hz", (-0.5, 0.0), (0.5,)),
        (SettlingTime, T, "band_percent", (0.0, 100.5), (0.5, 100.0)),
        (SettlingTime, T, "mean_s", (-0.5, 0.0), (0.5,)),
        (SettlingTime, T, "low_pass_hz", (-0.5, 0.0), (0.5,)),
        (SettlingTime, T, "step_size", (-0.5, 0.0), (0.5,)),
        (OvershootPercent, T, "step_size", (-0.5, 0.0), (0.5,)),
    ],
)
def test_options_have_limits(
    metric: type[Metric],
    base: dict[str, Any],
    option: str,
    refused: tuple[float, ...],
    taken: tuple[float, ...],
) -> None:
    for value in refused:
        with pytest.raises(ValidationError, match=option):
            metric(**base | {option: value})
    for value in taken:
        assert getattr(metric(**base | {option: value}), option) == value


@pytest.mark.parametrize(("from_s", "to_s"), [(5.0, 5.0), (5.0, 4.0), (0.5, 0.25)])
def test_a_window_runs_forward(from_s: float, to_s: float) -> None:
    with pytest.raises(ValidationError, match="not after from_s"):
        Peak(channel="shaft_torque_nm", from_s=from_s, to_s=to_s)


@pytest.mark.parametrize(("from_hz", "to_hz"), [(8.0, 8.0), (8.0, 7.0)])
def test_a_band_runs_upward(from_hz: float, to_hz: float) -> None:
    with pytest.raises(ValidationError, match="not above from_hz"):
        BandEnergy(channel="shaft_torque_nm", from_hz=from_hz, to_hz=to_hz)


@pytest.mark.parametrize("missing", ["unit", "definition", "compute"])
def test_a_metric_says_its_unit_and_definition_and_computes(missing: str) -> None:
    def compute(self: Metric, recording: Recording, segment: Segment) -> float:
        return 0.0

    whole: dict[str, Any] = {
        "__module__": __name__,
        "unit": property(lambda self: "s"),
        "definition": property(lambda self: "Zero."),
        "compute": compute,
    }
    assert type("Whole", (Metric,), dict(whole))().unit == "s"
    del whole[missing]
    with pytest.raises(TypeError, match=missing):
        type("Partial", (Metric,), whole)()
