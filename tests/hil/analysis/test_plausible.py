"""Data that no axle gives, copies, and the same measurement under two names."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.diagnosis import diagnose
from hil.analysis.frequency_response import experiments_of
from hil.analysis.plausible import (
    LARGEST_VALUE,
    refuse_implausible,
    refuse_same_data,
    same_data,
    within_floating_point,
)
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.recording import Recording
from tests.hil.analysis.degenerate import MODEL, recording

GOOD = recording("as it should be")


def renamed(one: Recording, name: str) -> Recording:
    channels = {channel: values.copy() for channel, values in one.channels.items()}
    return dataclasses.replace(one, channels=channels, source=Path(name))


@pytest.mark.parametrize("channel", [INPUT, *OUTPUTS])
@pytest.mark.parametrize("value", [1e308, -1e200, 2 * LARGEST_VALUE, np.inf, np.nan])
def test_a_value_that_no_axle_gives_is_refused_with_its_place(channel: str, value: float) -> None:
    bad = renamed(GOOD, "bad.csv")
    bad.channels[channel][1234] = value
    for refusing in (refuse_implausible, experiments_of, lambda r: diagnose(MODEL, [r])):
        with pytest.raises(BadInputError) as caught:
            refusing(bad)
        assert f"'{channel}'" in caught.value.what
        assert "1.234 s" in caught.value.what
        assert caught.value.where == "bad.csv"


def test_a_copy_of_a_channel_is_refused_by_both_names() -> None:
    for one, other in ((OUTPUTS[0], OUTPUTS[2]), (INPUT, OUTPUTS[2])):
        bad = renamed(GOOD, "bad.csv")
        bad.channels[other] = bad[one].copy()
        with pytest.raises(BadInputError, match="equal at every sample") as caught:
            refuse_implausible(bad)
        assert one in caught.value.what
        assert other in caught.value.what


def test_the_same_data_under_two_names_are_the_same() -> None:
    again = renamed(GOOD, "again.csv")
    again.channels["time_s"] += 5.0
    again.channels["vehicle_speed_m_s"] = np.zeros(len(again.time_s))
    assert same_data(GOOD, again)
    other = renamed(GOOD, "other.csv")
    other.channels[OUTPUTS[0]][7] += 1e-9
    assert not same_data(GOOD, other)
    fewer = renamed(GOOD, "fewer.csv")
    del fewer.channels[OUTPUTS[2]]
    assert not same_data(GOOD, fewer)
    assert not same_data(GOOD, GOOD.between(0.0, 2.0))


@pytest.mark.parametrize("held", [True, False])
def test_a_diagnosis_counts_data_once(held: bool) -> None:
    again = renamed(GOOD, "again.csv")
    other = dataclasses.replace(recording("as it should be", seed=1), source=Path("other.csv"))
    fitted, holdout = ([GOOD, other], [again]) if held else ([GOOD, other, again], [])
    with pytest.raises(BadInputError) as caught:
        diagnose(MODEL, fitted, holdout)
    assert caught.value.where == "again.csv"
    assert str(GOOD.source) in caught.value.what
    assert ("held out" if held else "twice") in caught.value.what
    refuse_same_data([GOOD, other])
    with pytest.raises(BadInputError, match="twice"):
        refuse_same_data([other], [GOOD, again])


@pytest.mark.parametrize(
    "broken",
    [
        lambda: np.linalg.solve(np.zeros((2, 2)), np.ones(2)),
        lambda: np.linalg.eigvals(np.full((2, 2), np.nan)),
        lambda: 1.0 / 0.0,
        lambda: float(10**400),
    ],
)
def test_arithmetic_that_breaks_down_is_bad_input(broken) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInputError, match="cannot be computed") as caught, within_floating_point("r.csv"):
        broken()
    assert caught.value.where == "r.csv"


def test_other_errors_stay_what_they_are() -> None:
    with pytest.raises(ValueError, match="a mistake"), within_floating_point("r.csv"):
        raise ValueError("a mistake of ours")


def test_speeds_of_a_direct_drive_may_be_equal() -> None:
    direct = renamed(GOOD, "direct.csv")
    direct.channels[OUTPUTS[1]] = direct[OUTPUTS[0]].copy()
    refuse_implausible(direct)
