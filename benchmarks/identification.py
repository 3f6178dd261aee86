"""How long identification and control design take, side by side with what scipy and python-control do."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import control
import numpy as np
from scipy import signal

from benchmarks.answers import largest_difference
from hil.analysis.control_design import DesignSpec, design, margins
from hil.analysis.frequency_response import averaged_spectra, estimate, experiments_of
from hil.analysis.identification import choose_chain, choose_order, fit
from hil.core.channels import OUTPUTS
from tests.hil.analysis import paper_plant, paper_table
from tests.hil.analysis.conftest import GRID, exact

REPEATS = 5
#: How far another way may be off and count as an answer: median of a response, a share; |S|, dB and degrees.
SAME_RESPONSE, SAME_MARGINS = 0.05, 0.2


def main() -> None:
    """Print best and median wall time of each task, and what it found."""
    rows = [*_fits(), *_responses(), *_loops()]
    print(f"{'task':<58}{'best ms':>9}{'median ms':>11}  found")
    for name, best, median, found in rows:
        print(f"{name:<58}{1e3 * best:>9.1f}{1e3 * median:>11.1f}  {found}")


def _timed(call: Callable[[], str], repeats: int = REPEATS) -> tuple[float, float, str]:
    found = call()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times), float(np.median(times)), found


def _fits() -> list[tuple[str, float, float, str]]:
    truth = np.array([paper_plant.response(name, GRID) for name in OUTPUTS])
    data = exact(truth, 0.01)

    def one() -> str:
        found = fit(data, 5)
        error = np.sqrt(np.mean(np.abs(found.modes.response(GRID) / truth - 1) ** 2))
        return f"rms error {error:.1e}, dead time {found.modes.delay_s * 1e3:.3f} ms; target 100 ms"

    def order() -> str:
        return f"order {choose_order(data).best.order}"

    def chain() -> str:
        return choose_chain(data, torque_delay_s=0.008).best.model.kind

    return [
        ("fit: 3 responses x 400 points, order 5, dead time", *_timed(one)),
        ("order by evidence: 7 candidates, held-out fits", *_timed(order, 3)),
        ("chain: rigid, two and three inertias, several starts", *_timed(chain, 3)),
    ]


def _responses() -> list[tuple[str, float, float, str]]:
    recording = paper_plant.recording(np.tile(paper_plant.chirp(200.0), 3))
    experiments = experiments_of(recording)
    step = paper_plant.STEP_S

    def error(frequency: np.ndarray, response: np.ndarray) -> str:
        inside = (frequency >= 0.05) & (frequency <= 30)
        truth = paper_plant.response(OUTPUTS[0], frequency[inside])
        off = float(np.median(np.abs(response[inside] / truth - 1)))
        largest_difference("the response", off, 0.0, SAME_RESPONSE)
        return f"median error of ω_m {off:.2%}"

    def local() -> str:
        frf = estimate(experiments)
        return error(frf.frequency_hz, frf.response[0]) + "; target 1000 ms"

    def h1() -> str:
        frf = averaged_spectra(experiments, 0.05, 30)
        return error(frf.frequency_hz, frf.response[0])

    def scipy_csd() -> str:
        torque = recording["motor_torque_ref_nm"]
        options: dict[str, Any] = {"fs": 1 / step, "nperseg": 80_000}
        frequency, auto = signal.welch(torque, **options)
        cross = [signal.csd(torque, recording[name], **options)[1] for name in OUTPUTS]
        hold = np.exp(1j * np.pi * step * frequency)
        return error(frequency, cross[0] / auto * hold)

    name = "frequency response, 10 min at 1 kHz, 3 outputs:"
    return [
        (f"{name} local poly.", *_timed(local)),
        (f"{name} H1", *_timed(h1)),
        (f"{name} scipy csd", *_timed(scipy_csd)),
    ]


def _loops() -> list[tuple[str, float, float, str]]:
    model = paper_table.paper_model()
    found = design(model, DesignSpec())
    loop = found.loop("phase").sampled
    data = control.FrequencyResponseData(loop, 2 * np.pi * found.frequency_hz)

    def words(peak: float, decibel: float, turn: float) -> str:
        return f"|S|max {peak:.4f}, {decibel:.2f} dB, {turn:.2f}°"

    def own() -> tuple[float, float, float]:
        m = margins(found.frequency_hz, loop, 2)
        return m.sensitivity_peak, m.gain_margin_db, m.phase_margin_deg

    def controls() -> tuple[float, float, float]:
        gain, phase, modulus, *_ = control.stability_margins(data, returnall=True)
        turn = np.min(np.abs((np.asarray(phase) + 180) % 360 - 180))
        return float(1 / np.min(modulus)), float(np.min(np.abs(20 * np.log10(gain)))), float(turn)

    def mine() -> str:
        return words(*own())

    def other() -> str:
        return words(*controls())

    largest_difference("python-control's margins", own(), controls(), SAME_MARGINS)

    def optimum() -> str:
        best = design(model, DesignSpec(optimise=True)).loop("phase").margins.comfort_peak
        paper = found.loop("phase").margins.comfort_peak
        return f"max |S| in 8-20 Hz {best:.3f}, the paper's lead {paper:.3f}"

    return [
        ("margins of one loop", *_timed(mine)),
        ("margins of one loop: python-control", *_timed(other, 3)),
        ("design --optimize, 41 plants", *_timed(optimum, 1)),
    ]


if __name__ == "__main__":
    main()
