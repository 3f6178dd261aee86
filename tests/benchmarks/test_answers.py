"""Benchmarks compare programs that computed the same; the C plant reads the kernels' own table of slots."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from benchmarks.answers import OtherAnswerError, largest_difference
from benchmarks.c_plant import compiled_c, header, refuse_more
from hil.core.model import EffectUse, load_model
from hil.engine.bench.bench_file import shipped
from hil.plant import kernel, slots

SAMPLES, DT, STEP = 300, 1e-3, 1e-4


@pytest.mark.parametrize(
    ("others", "said"),
    [
        ([1.0, np.nan], "C: 1 of 2 values are no finite numbers"),
        ([1.0, np.inf], "no finite numbers"),
        ([1.0], "values where"),
        ([1.0, 2.1], "differs by up to 0.1, 0.01 is allowed"),
    ],
)
def test_another_answer_is_refused(others: list[float], said: str) -> None:
    with pytest.raises(OtherAnswerError, match=said):
        largest_difference("C", [1.0, 2.0], others, 0.01)


def test_an_answer_of_ours_that_is_no_number_is_refused() -> None:
    with pytest.raises(OtherAnswerError, match="this program: 1 of 1"):
        largest_difference("C", [np.nan], [1.0], 1.0)


def test_the_difference_is_in_the_unit_or_a_share() -> None:
    assert largest_difference("C", [100.0, 2.0], [101.0, 2.0], 2.0) == 1.0
    assert largest_difference("C", [100.0], [101.0], 0.1, relative=True) == pytest.approx(1 / 101)


def test_every_slot_has_its_place_in_the_header() -> None:
    places = dict(line.split()[1:] for line in header().splitlines())
    assert len(places) == len(slots.SLOTS)
    assert places["AT_gear_ratio"] == str(slots.GEAR_RATIO)
    order = slots.place("wheel_order_disturbance", "order")
    assert places["AT_wheel_order_disturbance_order"] == str(order)


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_c_and_kernel_compute_the_same(tmp_path: Path) -> None:
    vector = slots.pack(load_model(shipped("three_inertia.toml")))
    refuse_more(vector)
    torque, load = np.full(SAMPLES, 40.0), np.zeros(SAMPLES)
    ours, others = kernel.empty_output(SAMPLES), kernel.empty_output(SAMPLES)
    kernel.run(torque, load, True, DT, vector, np.zeros(kernel.START_COLUMNS), STEP, ours)
    compiled_c(tmp_path, DT, STEP)(torque, vector, others)
    assert np.max(np.abs(ours[:, 0])) > 1.0
    assert largest_difference("C", ours, others, 1e-6) < 1e-6


def test_what_the_c_side_does_not_have_is_refused() -> None:
    model = load_model(shipped("three_inertia.toml"))
    vector = slots.pack(model.with_effects(EffectUse("backlash", {"half_gap_rad": 0.02})))
    with pytest.raises(OtherAnswerError, match=r"plant.c has no backlash.half_gap_rad"):
        refuse_more(vector)
    vector = slots.pack(model.with_effects())
    vector[slots.KIND] = slots.TWO_INERTIA
    with pytest.raises(OtherAnswerError, match="kind"):
        refuse_more(vector)
