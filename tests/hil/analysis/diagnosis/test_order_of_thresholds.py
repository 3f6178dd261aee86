"""Thresholds that lie on one scale stand in the order that their meanings ask for."""

from __future__ import annotations

import math

from hil.analysis.diagnosis.fit import thresholds as fit
from hil.analysis.diagnosis.tell import thresholds as tell


def test_a_correction_is_smaller_than_a_finding_and_a_finding_than_what_may_be_found() -> None:
    # what a parameter may be corrected by, lies beyond its tolerance, so that a finding is seen as one
    assert 0.0 < fit.PRIOR < math.log1p(fit.TOLERANCE) < fit.REACH < fit.MISMATCH_REACH
    assert fit.STEP < fit.PRIOR
    assert list(fit.TRIALS) == sorted(fit.TRIALS, reverse=True)
    assert all(0.0 < trial <= 1.0 for trial in fit.TRIALS)
    assert fit.HUGE <= fit.DIVERGED


def test_the_less_is_closed_the_less_sure_a_name_is() -> None:
    assert 1.0 < tell.CLOSED_WELL < tell.CLOSED_FAIRLY
    sure = (1.0 - tell.CONFIDENCE_FLOOR, tell.FAIRLY_SURE, tell.LESS_SURE, tell.OPEN_CONFIDENCE)
    assert list(sure) == sorted(sure, reverse=True)
    assert all(0.0 < one < 1.0 for one in sure)
    shares, limits = zip(*tell.SHUT, strict=True)
    assert list(shares) == sorted(shares)
    assert list(limits) == sorted(limits)
    assert list(tell.SHARES) == sorted(tell.SHARES, reverse=True)
    assert tell.SLOW_KM_H < tell.FAST_KM_H
