from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hil.analysis.control_design import Design, DesignSpec, design
from hil.analysis.frequency_response import FrequencyResponse, estimate, experiments_of
from hil.analysis.identification import Identification, identify
from hil.core.channels import OUTPUTS
from hil.core.model import Model, TransferFunction
from hil.core.recording import Recording
from tests.hil.analysis import paper_plant


@pytest.fixture(scope="session")
def paper_recording() -> Recording:
    """Three chirps of 200 s through (14)-(16), 1 % noise."""
    return paper_plant.recording(np.tile(paper_plant.chirp(200.0), 3))


@pytest.fixture(scope="session")
def paper_frf(paper_recording: Recording) -> FrequencyResponse:
    return estimate(experiments_of(paper_recording))


@pytest.fixture(scope="session")
def paper_identification(paper_recording: Recording) -> Identification:
    return identify(experiments_of(paper_recording))


@pytest.fixture(scope="session")
def paper_model() -> Model:
    """(14)-(16) as a model file would hold them."""
    return Model(
        "transfer_function",
        transfer_functions={
            name: TransferFunction(paper_plant.NUMERATORS[name], paper_plant.DENOMINATOR, paper_plant.DELAY_S)
            for name in OUTPUTS
        },
    )


@pytest.fixture(scope="session")
def exact_frf() -> FrequencyResponse:
    """(14)-(16) at 400 frequencies without noise."""
    return exact(np.array([paper_plant.response(name, GRID) for name in OUTPUTS]))


@pytest.fixture(scope="session")
def paper_design(paper_model: Model) -> Design:
    """The paper's own lead, notch and gains."""
    return design(paper_model, DesignSpec(inertia_kg_m2=4.4625, notch_hz=10.6))


@pytest.fixture(scope="session")
def optimised_design(paper_model: Model) -> Design:
    return design(paper_model, DesignSpec(optimise=True))


GRID = np.geomspace(0.05, 30.0, 400)


def exact(response: np.ndarray, relative: float = 0.0, seed: int = 0) -> FrequencyResponse:
    """A frequency response on `GRID` with relative complex noise of a known standard deviation."""
    rng = np.random.default_rng(seed)
    noise = (rng.standard_normal(response.shape) + 1j * rng.standard_normal(response.shape)) / np.sqrt(2)
    deviation = relative * np.abs(response)
    zeros = np.zeros(response.shape)
    return FrequencyResponse(
        GRID, OUTPUTS, response + deviation * noise, zeros + 1, deviation, zeros, zeros, 1, "made"
    )


def outputs_of(frf: FrequencyResponse, count: int) -> FrequencyResponse:
    """The same response with its first `count` outputs only."""
    return replace(
        frf,
        outputs=frf.outputs[:count],
        response=frf.response[:count],
        coherence=frf.coherence[:count],
        standard_deviation=frf.standard_deviation[:count],
        noise=frf.noise[:count],
        nonlinear=frf.nonlinear[:count],
    )
