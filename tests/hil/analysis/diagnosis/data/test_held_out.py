"""Recordings that no fit has seen: how much of them may stay."""

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.diagnosis.data.gap import ChannelGap, Event, HeldOut, furthest
from hil.analysis.diagnosis.thresholds import MOMENT_S, VISIBLE
from hil.analysis.missing_effects import Verdict
from hil.core.channels import OUTPUTS
from tests.hil.analysis.diagnosis.one_recording import NOISE, one_series

ONCE = Event(OUTPUTS[2], "steps", 12.3, 8.0)


def held(event: Event | None = None, **noises: float) -> HeldOut:
    gaps = {channel: ChannelGap(0.01 * n, 0.01) for channel, n in noises.items()}
    return HeldOut(gaps, gaps, event)


@pytest.mark.parametrize("verdict", ["none", "named"])
def test_more_than_noise_is_told_whatever_the_verdict(verdict: Verdict) -> None:
    one = held(a=1.1, b=1.6)
    assert one.open(verdict) == ("b",)
    assert one.words(verdict).startswith(
        "held-out recordings leave 1.6 times its noise in b: something is missing"
    )
    assert one.words(verdict).endswith("give those held out as recordings too, and hold others out")
    assert held(a=1.1).words(verdict) == ""


def test_beside_a_name_whose_law_may_differ_a_little_more_may_stay_than_beside_none() -> None:
    assert (held(a=1.3).open("none"), held(a=1.3).open("named")) == (("a",), ())
    assert (held(a=VISIBLE).open("named"), held(a=VISIBLE + 0.01).open("named")) == ((), ("a",))


def test_a_moment_that_is_far_off_counts_where_nothing_is_said_to_be_missing() -> None:
    one = held(ONCE, a=1.1)
    assert one.words("none").startswith(
        f"held-out recording steps is off by 8 times the noise in {OUTPUTS[2]} at 12.3 s: something"
    )
    assert one.words("named") == ""


def test_where_the_fitted_ones_are_not_explained_there_is_nothing_to_add() -> None:
    assert held(ONCE, a=9.0).words("unknown") == ""


def test_a_limit_that_is_met_once_is_the_moment_that_is_furthest_off() -> None:
    trace = one_series(seconds=8.0)
    shown = trace.samples.copy()
    noise = np.array(NOISE)
    calm = furthest([trace], noise, [shown + np.random.default_rng(0).normal(size=shown.shape) * noise])
    assert calm is not None
    assert calm.noises < 1.5
    shown[5000:5200, 2] += 8.0 * NOISE[2]
    event = furthest([trace], noise, [shown])
    assert event is not None
    assert (event.channel, event.recording) == (OUTPUTS[2], trace.name)
    assert event.time_s == pytest.approx(5.0 + 0.5 * MOMENT_S)
    assert event.noises == pytest.approx(8.0)


def test_an_angle_that_was_not_recorded_may_be_what_is_wrong() -> None:
    words = replace(held(a=9.0), walks=True).words("named")
    assert "walks off with that speed's noise (record the angle), or something is missing" in words
    assert "angle" not in held(a=9.0).words("named")
