"""Buckets as JSON: what each viewer is sent is what was measured, whatever it asks for."""

from __future__ import annotations

import json

import numpy as np

from hil.service.live.bucket_texts import BucketTexts
from hil.service.live.live import BUCKET_S, Buckets

NAMES = ["time_s", "motor_speed_rad_s", "shaft_torque_nm"]


def filled(seconds: float) -> Buckets:
    time = np.arange(round(seconds * 1000)) * 1e-3
    buckets = Buckets()
    buckets.add(NAMES, np.column_stack([time, np.sin(time), np.where(time % 1 < 0.1, np.nan, 1e6 * time)]))
    buckets.show(1e3)
    return buckets


def test_any_stretch_is_that_of_the_buckets() -> None:
    buckets = filled(3.0)
    texts = BucketTexts(buckets)
    for first, last in ((0, 5), (2, 9), (50, 149), (7, 7)):
        found = json.loads(f"{{{texts.of('shaft_torque_nm', first, last)}}}")["shaft_torque_nm"]
        stretch = [buckets.bucket(number) for number in range(first, last)]
        for name, end in (("lowest", 0), ("highest", 1)):
            meant = [None if np.isnan(one[end][1]) else float(f"{one[end][1]:.6g}") for one in stretch]
            assert found[name] == meant


def test_what_is_gone_is_forgotten() -> None:
    buckets = filled(300.0)
    texts = BucketTexts(buckets)
    for number in range(buckets.oldest, buckets.shown):
        texts.of("motor_speed_rad_s", number, number + 1)
    assert len(texts._texts) <= 60.0 / BUCKET_S
