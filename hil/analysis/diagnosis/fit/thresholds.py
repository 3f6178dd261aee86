"""Thresholds of the fit: how far numbers go, how long is fitted."""

from __future__ import annotations

from typing import Annotated

from hil.analysis.diagnosis.threshold import Means

TOLERANCE: Annotated[
    float,
    Means("relative", "calibration tolerance of a parameter: beyond it a wrong value is a finding", "blind"),
] = 0.02
REACH: Annotated[
    float, Means("natural logarithm", "how far a parameter may go as a mere correction", "blind")
] = 0.03
PRIOR: Annotated[
    float, Means("natural logarithm", "standard deviation of a parameter's correction", "blind")
] = 0.015
MISMATCH_REACH: Annotated[
    float,
    Means("natural logarithm", "how far a wrong parameter may go: a factor of five either way", "blind"),
] = 1.6
LOSS_REACH: Annotated[
    float,
    Means(
        "natural logarithm", "the same of a loss in a far model, often guessed: a factor of twenty", "race"
    ),
] = 3.0
FAR_PRIOR: Annotated[
    float,
    Means("natural logarithm", "standard deviation of a parameter that is as good as unknown", "far"),
] = 0.7
RATIO_PRIOR: Annotated[
    float, Means("natural logarithm", "the same of a gear ratio: teeth are counted", "far")
] = 0.1
COARSE_S: Annotated[
    tuple[float, ...],
    Means("s", "means over so long are fitted first where parameters are far: slow motion, then fast", "far"),
] = (0.256, 0.064, 0.016)
COARSE_BLOCKS: Annotated[int, Means("means", "of a recording: fewer tell little", "far")] = 50
FAR_ROUNDS: Annotated[int, Means("rounds", "of each of these fits", "far")] = 8
STEP: Annotated[
    float, Means("natural logarithm, or typical sizes", "finite difference of a coordinate", "hidden")
] = 1e-3
SMOOTHER: Annotated[
    float,
    Means(
        "of the squared error of a held request",
        "a smooth one must leave less: requests are mostly held",
        "trace",
    ),
] = 0.8
UNSURE: Annotated[
    tuple[float, float],
    Means(
        "of what a held and a smooth request do differently",
        "so much of a coarsely sampled channel counts as not known: what is not smooth nor held does, and of "
        "steps no one knows when between two samples they came",
        "trace",
    ),
] = (0.1, 1.0)
MOST_ROUNDS: Annotated[int, Means("rounds", "of a fit at most", "hidden")] = 14
SLIDE_ROUNDS: Annotated[
    int, Means("rounds", "of a descent by another fit's derivatives, its first look included", "slide")
] = 8
POLISHED: Annotated[
    float,
    Means(
        "squared error, noise variances", "the last step of the fit that is stated gains less", "covariance"
    ),
] = 0.01
WORTH_A_LEAP: Annotated[
    float,
    Means("squared error, noise variances", "a dead time in another sample must gain more", "whole_samples"),
] = 10.0
SAME_COST: Annotated[
    float, Means("relative", "sums of squared errors are the same: nothing has changed", "transfer_functions")
] = 1e-9

TRIALS: Annotated[tuple[float, ...], Means("of a step", "tried in each round", "least_squares")] = (1.0, 0.35)
AS_PROMISED: Annotated[
    float,
    Means(
        "of what derivatives promise",
        "a whole step that gains more is taken: a part gains less",
        "least_squares",
    ),
] = 0.75
MORE_THAN_PROMISED: Annotated[
    float,
    Means(
        "of what derivatives promise", "a step that gains more may be longer the next time", "least_squares"
    ),
] = 1.5
LONGER: Annotated[float, Means("times as long", "the step that is tried then as well", "least_squares")] = 3.0
LONGEST: Annotated[float, Means("of a step", "is tried at most", "least_squares")] = 10.0
MOST_REFUSALS: Annotated[int, Means("steps", "refused before a fit gives up", "least_squares")] = 4

HUGE: Annotated[float, Means("noise levels", "errors of a diverged simulation are cut to it", "problem")] = (
    1e9
)
DIVERGED: Annotated[
    float, Means("noise levels", "a larger change is no derivative that could be followed", "problem")
] = 1e9
LEAD_S: Annotated[
    float,
    Means(
        "s",
        "of a recording that begins in motion do not count: torque asked for before acts there",
        "problem",
    ),
] = 0.02
LEAD_PART: Annotated[
    int, Means("of a recording", "one part in so many is the most that does not count so", "problem")
] = 20
REST_SHARE: Annotated[float, Means("of a sample's noise", "how still an axle at rest is held", "problem")] = (
    0.1
)
REST_SIGMAS: Annotated[
    float, Means("standard deviations", "a mean speed nearer to zero may be rest", "problem")
] = 4.0
MID_MOTION: Annotated[
    tuple[float, float],
    Means(
        "rad/s and rad, wheel side",
        "how far vehicle and wheel may differ, and the tyre be twisted, as a recording begins",
        "problem",
    ),
] = (1.0, 0.1)
REST_SAMPLES: Annotated[int, Means("samples", "in that mean", "problem")] = 20
FINE: Annotated[
    float,
    Means(
        "noise with rounding over that without",
        "a coarser channel reads zero at many speeds and tells no rest",
        "problem",
    ),
] = 2.0

FAR_FROM_NOISE: Annotated[
    float,
    Means(
        "noise powers",
        "where more is left errors are weighed by their own spectrum: else the strongest resonance sets all",
        "blind",
    ),
] = 50.0

MISS_WORSE: Annotated[float, Means("times the rms error", "that other weights may cost at most", "blind")] = (
    1.6
)

CLUSTER_S: Annotated[
    float, Means("s", "of errors that may know of each other in a standard error", "covariance")
] = 2.0
CLUSTERS: Annotated[int, Means("stretches", "at least, of short recordings shorter ones", "covariance")] = 20

SMOOTHED: Annotated[
    float,
    Means("factor in frequency", "of what a spectrum of errors is averaged over, either way", "covariance"),
] = 1.25
FALLS_NOT: Annotated[
    int,
    Means(
        "periods in the longest recording",
        "slower errors are taken to be no weaker than faster ones: a fit has taken some of them up",
        "covariance",
    ),
] = 30
LEAST_LINES: Annotated[
    int, Means("frequencies", "that it is averaged over at least, either way", "covariance")
] = 8

WHITENING_ORDER: Annotated[
    int, Means("blocks", "memory of the filters that make errors white", "whitening")
] = 16

EDGE: Annotated[
    float,
    Means("of a sample", "a descent of a rigid axle's dead time keeps from either end", "whole_samples"),
] = 1e-3
AT_BEND: Annotated[
    float, Means("of a sample", "a dead time beside a lag so near to a whole one ends there", "whole_samples")
] = 0.02
BESIDE_BEND: Annotated[
    float, Means("of a sample", "from there it begins again on either side", "whole_samples")
] = 0.15
JUST: Annotated[
    float, Means("of a sample", "a delay nearer to a whole sample is just one", "whole_samples")
] = 0.02
COINCIDENCE: Annotated[
    float,
    Means(
        "squared error, noise variances",
        "price of a channel that is late by just a sample: dead time is by nature",
        "whole_samples",
    ),
] = 50.0
LEAPS: Annotated[tuple[int, ...], Means("samples", "that a dead time is tried to leap", "whole_samples")] = (
    -4,
    -3,
    -2,
    -1,
    1,
    2,
    3,
    4,
)
