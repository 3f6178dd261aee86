"""The diagnosis' own bounded quadratic step against scipy's bounded linear least squares."""

from __future__ import annotations

import time

import numpy as np
from scipy.optimize import lsq_linear

from benchmarks.answers import largest_difference
from hil.analysis.diagnosis.fit.least_squares import box_step

TIMES, SIZE, ROWS = 200, 12, 40
SAME = 1e-6  # in numbers of about 0.3


def main() -> None:
    """Print microseconds a call, and how far the two answers are apart."""
    random = np.random.default_rng(1)
    ours = scipys = apart = 0.0
    for _ in range(TIMES):
        a, b = random.normal(size=(ROWS, SIZE)), random.normal(size=ROWS) * 3.0
        lower, upper = -np.full(SIZE, 0.3), np.full(SIZE, 0.2)
        matrix, gradient = a.T @ a, a.T @ b
        start = time.process_time()
        mine = box_step(matrix, gradient, lower, upper)
        ours += time.process_time() - start
        start = time.process_time()
        # what a fit has are the normal equations of 100,000 rows: their Cholesky factor stands for the rows
        factor = np.linalg.cholesky(matrix)
        theirs = lsq_linear(factor.T, np.linalg.solve(factor, gradient), (lower, upper), method="bvls").x
        scipys += time.process_time() - start
        apart = max(apart, largest_difference("scipy lsq_linear", mine, theirs, SAME))
    print(f"box_step {1e6 * ours / TIMES:.0f} us, scipy lsq_linear (bvls) {1e6 * scipys / TIMES:.0f} us")
    print(f"answers apart by at most {apart:.1e}; {SIZE} numbers, bounds of which about half are met")


if __name__ == "__main__":
    main()
