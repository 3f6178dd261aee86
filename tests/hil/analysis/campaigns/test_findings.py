"""Shares, intervals and correlations against closed forms and other libraries."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import beta, spearmanr

from hil.analysis.campaigns import Share, findings_of, rank_correlation
from test_plans import load_plan

CRITERION = load_plan("acceptance").criteria[0]
ID = CRITERION.id


def table(count=40):
    """Values that rise with `a`, fall with nothing else; the last is in trouble."""
    a = np.arange(count, dtype=float)
    value = 700.0 + a**2 / 20
    rows = pd.DataFrame(
        {
            "simulation": range(count),
            "controller": ["one", "other"] * (count // 2),
            "draw": 1,
            "model.a": a,
            "model.same": 1.0,
            f"value.{ID}": value,
            f"margin.{ID}": (723 - value) / 723,
            f"verdict.{ID}": np.where(value <= 723, "pass", "fail"),
            "margin": (723 - value) / 723,
            "verdict": np.where(value <= 723, "pass", "fail"),
            "error": None,
            "processor_s": 0.5,
        }
    )
    rows.loc[count - 1, [f"value.{ID}", f"margin.{ID}", "margin"]] = np.nan
    rows.loc[count - 1, f"verdict.{ID}"] = None
    rows.loc[count - 1, ["verdict", "error"]] = ["error", "it burst"]
    return rows


def test_each_controller_has_its_shares_worst_cases_and_correlations():
    found = findings_of(table(), [CRITERION], {"model.a": "kg", "model.same": "m"})
    assert (found.simulations, found.errors, found.processor_s) == (40, {"it burst": 1}, 20.0)
    assert found.inputs == {"model.a": "kg"}  # what is the same everywhere decides nothing
    one, other = found.controllers
    assert (one.name, other.name, one.errors, other.errors) == ("one", "other", 0, 1)
    assert one.share == Share(11, 20)  # a = 0, 2 … 20
    assert found.least_share == other.share.value == 11 / 20  # a = 1, 3 … 21; one could not be simulated
    assert other.criteria[0].share == Share(11, 19)
    assert one.criteria[0].correlations["model.a"] == pytest.approx(1.0)
    assert [worst.simulation for worst in one.worst] == [38, 36, 34, 32, 30, 28, 26, 24, 22, 20]
    assert one.worst[0].binding == ID
    assert one.worst[0].inputs == {"model.a": 38.0}


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_is_that_of_clopper_and_pearson(counts):
    k, n = counts
    low, high = Share(k, n).interval
    assert low == pytest.approx(beta.ppf(0.025, k, n - k + 1) if k else 0.0, abs=1e-9)
    assert high == pytest.approx(beta.ppf(0.975, k + 1, n - k) if k < n else 1.0, abs=1e-9)


def test_rank_correlations_are_spearmans_with_ties_and_gaps():
    random = np.random.default_rng(0)
    first = random.integers(0, 5, 60).astype(float)
    second = first + random.normal(0, 2, 60)
    second[7] = np.nan
    there = np.isfinite(second)
    assert rank_correlation(first, second) == pytest.approx(spearmanr(first[there], second[there]).statistic)
    assert np.isnan(rank_correlation(first, np.ones(60)))
    assert np.isnan(rank_correlation(first[:4], second[:4]))


def test_nothing_at_all_has_no_share():
    assert np.isnan(Share(0, 0).value)
    assert Share(0, 0).interval == (0.0, 1.0)
