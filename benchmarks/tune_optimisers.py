"""Optimisers on the task of `hil tune`: worst margin after the same number of runs, over ten seeds.

The acceptance plan with steps of 6 s in place of 20 and a band energy from 2 to 6 s; the shipped free
parameters.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import tempfile
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution, direct, dual_annealing, minimize

from benchmarks.tuning import acceptance_trial
from hil.analysis.tuning import Space, Trial, values_of
from test_plans import load_plan

SEEDS = 10


class _SpentError(Exception):
    """All runs are used up."""


class Budget:
    """The cost of a point of the unit cube, so often and no oftener; `best` is the best score so far."""

    def __init__(self, trial: Trial, runs: int) -> None:
        self.space = Space(trial.free.free)
        self.start = self.space.point(values_of(trial.start))
        self._trial, self._left, self.best = trial, runs, -np.inf

    def __call__(self, point: Any) -> float:
        if self._left == 0:
            raise _SpentError
        self._left -= 1
        score = self._trial.tried(self.space.values(np.asarray(point)), 0).score
        self.best = max(self.best, score)
        return -score


def evolution_then_simplex(cost: Budget, random: np.random.Generator, runs: int) -> None:
    """As `hil tune` does: two thirds differential evolution, then Nelder and Mead from the best."""
    members = 5 * cost.space.size
    first = random.uniform(0, 1, (members, cost.space.size))
    first[0] = cost.start
    settings: Any = {"init": first, "maxiter": max(1, round(0.66 * runs / members) - 1), "polish": False}
    found = differential_evolution(cost, _bounds(cost), tol=0.0, updating="deferred", seed=random, **settings)
    _simplex(cost, found.x)


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


def _bounds(cost: Budget) -> Any:
    return [(0.0, 1.0)] * cost.space.size


def _simplex(cost: Budget, start: Any) -> None:
    inward = np.where(start > 0.5, -0.08, 0.08)
    options: Any = {"initial_simplex": np.vstack([start, start + np.diag(inward)]), "adaptive": True}
    minimize(cost, start, method="Nelder-Mead", bounds=_bounds(cost), options=options | {"xatol": 1e-3})


OPTIMISERS: dict[str, Callable[[Budget, np.random.Generator, int], None]] = {
    "differential evolution, then Nelder-Mead": evolution_then_simplex,
    "DIRECT, then Nelder-Mead": rectangles,
    "dual annealing": annealing,
    "Nelder-Mead from start and random points": simplex_from_anywhere,
}


def _shortened(folder: Path) -> Path:
    text = load_plan("acceptance").text.replace("after_s: 20", "after_s: 6")
    text = text.replace(
        "metric: band_energy_motor_speed", "metric: band_energy_motor_speed, from_s: 2, to_s: 6"
    )
    text = text.replace("speed, from_s: 2, to_s: 6\n", "speed\n    from_s: 2\n    to_s: 6\n")
    file = folder / "acceptance_6s.yaml"
    file.write_text(text)
    return file


def outcome(name: str, seed: int, runs: int) -> float:
    """Best score of one optimiser with one seed."""
    with tempfile.TemporaryDirectory() as folder:
        trial = acceptance_trial(plan=_shortened(Path(folder)))
    cost = Budget(trial, runs)
    with contextlib.suppress(_SpentError):
        OPTIMISERS[name](cost, np.random.default_rng(seed), runs)
    return cost.best


def main() -> None:
    """Print median, worst and best of ten seeds for each."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--runs", type=int, default=400)
    asked.add_argument("--seeds", type=int, default=SEEDS)
    given = asked.parse_args()
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    print(f"{'score in % after ' + str(given.runs) + ' runs':<46}{'median':>8}{'worst':>8}{'best':>8}")
    with ProcessPoolExecutor(len(os.sched_getaffinity(0))) as executor:
        for name in OPTIMISERS:
            waiting = [executor.submit(outcome, name, seed, given.runs) for seed in range(given.seeds)]
            scores = [100 * one.result() for one in waiting]
            print(f"{name:<46}{np.median(scores):>8.2f}{min(scores):>8.2f}{max(scores):>8.2f}", flush=True)


if __name__ == "__main__":
    main()
