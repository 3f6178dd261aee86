"""The paper's (14)-(16) as a test plant, simulated without any code of the project.

scipy discretises it exactly for an input that is held between samples; the dead time is a whole
number of samples.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import signal

from hil.core.recording import Recording

DENOMINATOR = (1.0, 71.59, 6376.0, 2.399e5, 3.867e6, 0.0)
NUMERATORS = {
    "motor_speed_rad_s": (46.35, 2604.0, 8.768e4, 5.302e4, 8.547e5),
    "wheel_speed_rad_s": (45.99, 5664.0, 6839.0, 1.049e5),
    "shaft_torque_nm": (212.7, 5.23e4, 1.947e6, 3.14e7, 0.0),
}
DELAY_S = 0.008
STEP_S = 0.001


def response(output: str, frequency_hz: np.ndarray, delay_s: float = DELAY_S) -> np.ndarray:
    """The true response."""
    s = 2j * np.pi * frequency_hz
    return np.polyval(NUMERATORS[output], s) / np.polyval(DENOMINATOR, s) * np.exp(-delay_s * s)


def chirp(
    duration_s: float, from_hz: float = 0.05, to_hz: float = 30.0, amplitude_nm: float = 50.0
) -> np.ndarray:
    """Logarithmic chirp, N m, 1 kHz."""
    time = np.arange(round(duration_s / STEP_S)) * STEP_S
    return amplitude_nm * signal.chirp(time, from_hz, duration_s, to_hz, method="logarithmic", phi=-90)


def simulate(torque: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs at the input's samples."""
    delayed = np.concatenate([np.zeros(round(DELAY_S / STEP_S)), torque])[: len(torque)]
    outputs = {}
    for name, numerator in NUMERATORS.items():
        # Partial fractions: a high-order polynomial in z loses digits, second-order parts do not.
        residues, poles, _ = signal.residue(numerator, DENOMINATOR)
        modes = [_mode(r, p, delayed) for r, p in zip(residues, poles, strict=True)]
        outputs[name] = np.sum(modes, axis=0)
    return outputs


def _mode(residue: complex, pole: complex, torque: np.ndarray) -> np.ndarray:
    """Exact zero-order-hold response of residue/(s - pole); the sum over conjugates is real."""
    decay = np.exp(pole * STEP_S)
    gain = residue * (STEP_S if abs(pole) < 1e-9 else (decay - 1) / pole)
    return np.real(signal.lfilter([0.0, gain], [1.0, -decay], torque.astype(complex)))


def recording(torque: np.ndarray, noise: float = 0.01, seed: int = 0) -> Recording:
    """A recording with white noise of `noise` times each output's rms."""
    rng = np.random.default_rng(seed)
    channels = {"time_s": np.arange(len(torque)) * STEP_S, "motor_torque_ref_nm": torque}
    for name, values in simulate(torque).items():
        channels[name] = values + noise * np.std(values) * rng.standard_normal(len(values))
    return Recording(channels, Path("simulated"))
