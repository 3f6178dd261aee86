"""Starting poles by vector fitting (scikit-rf), with a scan of the dead time around it.

Gustavsen & Semlyen, IEEE Trans. Power Delivery 14 (1999) 1052. Vector fitting knows no dead time: with
8 ms left in, its poles are worthless (relative error 2.36). So it runs on data from which a trial dead
time was removed, for some trials, and what fits best starts the least squares.
"""

from __future__ import annotations

import warnings

import numpy as np
import numpy.typing as npt

from hil.analysis.identification._modal import Structure

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_ITERATIONS = 4


def starting_poles(
    frequency_hz: Array, response: ComplexArray, structure: Structure, delay_s: float
) -> Array:
    """Pole parameters of `structure` for data that carry about `delay_s` of dead time.

    Args:
        frequency_hz: F frequencies.
        response: O x F responses.
        structure: how many sections; a pole at the origin is taken out by multiplying with s.
        delay_s: trial dead time.
    """
    from skrf import Network
    from skrf.vectorFitting import VectorFitting

    s = 2j * np.pi * frequency_hz
    data = response * np.exp(delay_s * s) * (s if structure.integrator else 1.0)
    data = data / np.sqrt(np.mean(np.abs(data) ** 2, axis=1, keepdims=True))
    # Above one everywhere, the first value tells scikit-rf that this is no passive network; its test
    # of every frequency would take longer than the fit.
    data = data / max(0.5 * float(np.min(np.abs(data))), 1e-12)
    ports = int(np.ceil(np.sqrt(len(data))))
    matrix = data[np.arange(ports * ports) % len(data)].T.reshape(-1, ports, ports)
    fitting = VectorFitting(Network(f=frequency_hz, s=matrix, f_unit="hz"))
    fitting.max_iterations = _ITERATIONS
    fitting.poles = _spread(frequency_hz, structure)
    with warnings.catch_warnings():
        # It warns that it was stopped after few iterations (they are a start only) and that an axle
        # is not a passive network.
        warnings.simplefilter("ignore")
        fitting.vector_fit(init_pole_spacing="custom", fit_constant=structure.integrator)
    return pole_parameters(np.asarray(fitting.poles), structure)


def pole_parameters(poles: ComplexArray, structure: Structure) -> Array:
    """Section coefficients of `structure` for poles of which conjugates are left out.

    Real poles are paired into sections; what is missing in number is filled with the fastest pole.
    """
    pairs = [p for p in poles if p.imag != 0]
    real = sorted(-float(p.real) for p in poles if p.imag == 0)
    sections = [(-2 * float(p.real), float(abs(p)) ** 2) for p in pairs]
    single = real.pop() if structure.real_pole and len(real) % 2 else None
    while len(real) >= 2:
        a, b = real.pop(), real.pop()
        sections.append((a + b, a * b))
    fastest = max((c0 for _, c0 in sections), default=1e4)
    while len(sections) < structure.sections:
        sections.append((float(np.sqrt(fastest)), fastest))
    values = [value for section in sections[: structure.sections] for value in section]
    if structure.real_pole:
        values.append(single if single is not None else float(np.sqrt(fastest)))
    return np.asarray(np.maximum(np.array(values), 1e-6))


def _spread(frequency_hz: Array, structure: Structure) -> ComplexArray:
    """Lightly damped poles over the upper part of the band, where an axle has its modes."""
    low = max(float(frequency_hz[0]), float(frequency_hz[-1]) / 30)
    omega = 2 * np.pi * np.geomspace(low, 0.7 * float(frequency_hz[-1]), max(structure.sections, 1))
    poles = (-0.3 + 1j) * omega[: structure.sections]
    if structure.real_pole:
        poles = np.append(poles, -2 * np.pi * float(frequency_hz[-1]) / 3)
    return np.asarray(poles, complex)
