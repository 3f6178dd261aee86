"""Frequency responses from recordings: estimated, judged, and with an uncertainty at every frequency."""

from hil.analysis.frequency_response._estimate import DEFAULT_BAND_HZ, Method, estimate
from hil.analysis.frequency_response._experiment import (
    Experiment,
    Lines,
    experiments_of,
    fourier_lines,
    segments_of,
)
from hil.analysis.frequency_response._local_polynomial import local_polynomial
from hil.analysis.frequency_response._periodic import best_linear_approximation, period_samples
from hil.analysis.frequency_response._quality import Reason, UnfitDataError, check_coherence
from hil.analysis.frequency_response._result import Distortion, FrequencyResponse, frf_from_csv, frf_to_csv
from hil.analysis.frequency_response._welch import averaged_spectra

__all__ = [
    "DEFAULT_BAND_HZ",
    "Distortion",
    "Experiment",
    "FrequencyResponse",
    "Lines",
    "Method",
    "Reason",
    "UnfitDataError",
    "averaged_spectra",
    "best_linear_approximation",
    "check_coherence",
    "estimate",
    "experiments_of",
    "fourier_lines",
    "frf_from_csv",
    "frf_to_csv",
    "local_polynomial",
    "period_samples",
    "segments_of",
]
