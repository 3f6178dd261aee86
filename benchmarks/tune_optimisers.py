"""Optimisers on the task of `hil tune`: worst margin after the same numbers of runs, over ten seeds.

The acceptance plan with steps of 6 s in place of 20 and a band energy from 2 to 6 s; the shipped free
parameters. CMA-ES takes part where the package `cma` is there, which hil does not need.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import os
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution, direct, dual_annealing, minimize

from benchmarks.tuning import acceptance_trial
from hil.analysis.tuning import Ascent, Space, Trial, Tried, scatter, values_of
from test_plans import load_plan

SEEDS = 10
_COLUMNS = "median", "worst", "best"
ASCENT, AGAIN = (0.2, 1e-3, 25), (0.08, 1e-3, 25)  # radius, least radius, rounds
LOOP_LIMITS = ("sensitivity_peak", "gain_margin_db", "phase_margin_deg", "delay_margin_s")


class _SpentError(Exception):
    """All runs are used up."""


class Budget:
    """Tries points of the unit cube, so often and no oftener, and keeps them with their scores."""

    def __init__(self, trial: Trial, runs: int) -> None:
        self.space = Space(trial.free.free)
        self.start = self.space.point(values_of(trial.start))
        self.criteria = [criterion.id for criterion in trial.driven.criteria]
        self._trial, self._left = trial, runs
        self.points: list[Any] = []
        self.scores: list[float] = []

    def __call__(self, point: Any) -> float:
        """Cost of a point, for methods that know one number only."""
        return -self.tried([np.asarray(point)])[0][0].score

    def tried(self, points: Sequence[Any]) -> list[list[Tried]]:
        """All that is known of points."""
        found = []
        for point in points:
            if self._left == 0:
                raise _SpentError
            self._left -= 1
            found.append([self._trial.tried(self.space.values(point), 0)])
            self.points.append(point)
            self.scores.append(found[-1][0].score)
        return found


def ascents(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """As `hil tune` does: points all over the cube, then uphill from the best of them and from the start."""
    del runs
    scattered = scatter(cost.space.size, 60, random)
    scores = [-cost(point) for point in scattered]
    order = [cost.start, *(scattered[i] for i in np.argsort(scores)[::-1])]
    ascent = Ascent(cost.tried, cost.criteria, LOOP_LIMITS)
    for number, point in enumerate(order):
        ascent.execute(point, *ASCENT)
        if number == 6:
            ascent.execute(cost.points[int(np.argmax(cost.scores))], *AGAIN)


def evolution_then_ascent(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """Two thirds differential evolution, then uphill from the best."""
    found = _evolved(cost, random, runs)
    Ascent(cost.tried, cost.criteria, LOOP_LIMITS).execute(found, *ASCENT)


def rectangles_then_ascent(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """A third DIRECT, then uphill from its best."""
    del random
    found = direct(cost, _bounds(cost), maxfun=round(0.33 * runs), locally_biased=True)
    Ascent(cost.tried, cost.criteria, LOOP_LIMITS).execute(found.x, *ASCENT)


def evolution_then_simplex(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """Two thirds differential evolution, then Nelder and Mead from the best."""
    _simplex(cost, _evolved(cost, random, runs))


def _evolved(cost: Budget, random: np.random.Generator, runs: int) -> Any:
    members = 5 * cost.space.size
    first = random.uniform(0, 1, (members, cost.space.size))
    first[0] = cost.start
    settings: Any = {"init": first, "maxiter": max(1, round(0.66 * runs / members) - 1), "polish": False}
    return differential_evolution(
        cost, _bounds(cost), tol=0.0, updating="deferred", seed=random, **settings
    ).x


def simplex_from_anywhere(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """Nelder and Mead from the start, then from random points."""
    del runs
    _simplex(cost, cost.start)
    while True:
        _simplex(cost, random.uniform(0, 1, cost.space.size))


def annealing(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """scipy's dual annealing from the start."""
    settings: Any = {"x0": cost.start, "seed": random, "maxfun": 10 * runs}
    dual_annealing(cost, _bounds(cost), **settings)


def rectangles(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """scipy's DIRECT, which knows no chance, then Nelder and Mead from its best."""
    del random
    found = direct(cost, _bounds(cost), maxfun=round(0.66 * runs), locally_biased=True)
    _simplex(cost, found.x)


def covariance(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """CMA-ES from the start, started again with more members where it has converged."""
    cma = importlib.import_module("cma")
    settings = {"bounds": [0, 1], "seed": int(random.integers(1, 2**31)), "verbose": -9, "maxfevals": runs}
    cma.fmin2(cost, cost.start, 0.25, settings, restarts=9, bipop=True)


def _bounds(cost: Budget) -> Any:
    return [(0.0, 1.0)] * cost.space.size


def _simplex(cost: Budget, start: Any) -> None:
    inward = np.where(start > 0.5, -0.08, 0.08)
    options: Any = {"initial_simplex": np.vstack([start, start + np.diag(inward)]), "adaptive": True}
    minimize(cost, start, method="Nelder-Mead", bounds=_bounds(cost), options=options | {"xatol": 1e-3})


OPTIMISERS: dict[str, Callable[[Budget, np.random.Generator, int], None]] = {
    "ascents from the best of scattered points": ascents,
    "differential evolution, then ascent": evolution_then_ascent,
    "differential evolution, then Nelder-Mead": evolution_then_simplex,
    "DIRECT, then ascent": rectangles_then_ascent,
    "DIRECT, then Nelder-Mead": rectangles,
    "dual annealing": annealing,
    "Nelder-Mead from start and random points": simplex_from_anywhere,
    "CMA-ES (cma)": covariance,
}


NO_CHANCE = ("DIRECT, then ascent", "DIRECT, then Nelder-Mead")  # all seeds are one


def _shortened(folder: Path) -> Path:
    text = load_plan("acceptance").text.replace("after_s: 20", "after_s: 6")
    text = text.replace(
        "metric: band_energy_motor_speed", "metric: band_energy_motor_speed, from_s: 2, to_s: 6"
    )
    text = text.replace("speed, from_s: 2, to_s: 6\n", "speed\n    from_s: 2\n    to_s: 6\n")
    file = folder / "acceptance_6s.yaml"
    file.write_text(text)
    return file


def outcome(name: str, seed: int, runs: int) -> list[float]:
    """Best score of one optimiser with one seed so far, after each run."""
    with tempfile.TemporaryDirectory() as folder:
        trial = acceptance_trial(plan=_shortened(Path(folder)), keeping=False)
    cost = Budget(trial, runs)
    with contextlib.suppress(_SpentError):
        OPTIMISERS[name](cost, np.random.default_rng(seed), runs)
    return list(np.maximum.accumulate(cost.scores))


def main() -> None:
    """Print median, worst and best of ten seeds for each, after each number of runs."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--runs", type=int, default=1000)
    asked.add_argument("--after", type=int, nargs="+", default=[120, 400, 1000])
    asked.add_argument("--seeds", type=int, default=SEEDS)
    asked.add_argument("--only", nargs="+", default=list(OPTIMISERS))
    given = asked.parse_args()
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    names = [name for name in given.only if name != "CMA-ES (cma)" or importlib.util.find_spec("cma")]
    print(f"{'score in % of ' + str(given.seeds) + ' seeds':<44}{'runs':>6}", *map("{:>7}".format, _COLUMNS))
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as executor:
        seeds = {name: 1 if name in NO_CHANCE else given.seeds for name in names}
        waiting = {n: [executor.submit(outcome, n, s, given.runs) for s in range(seeds[n])] for n in names}
        for name, jobs in waiting.items():
            found = [job.result() for job in jobs]
            for runs in given.after:
                scores = [100 * best[min(runs, len(best)) - 1] for best in found]
                row = np.median(scores), min(scores), max(scores)
                print(f"{name:<44}{runs:>6}", *map("{:>7.2f}".format, row), flush=True)


if __name__ == "__main__":
    main()
