"""What a linear model of nonlinear, unrelated or wrongly wired data is worth, and that it is stated."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.control_design import DesignSpec, design
from hil.analysis.frequency_response import UnfitDataError, experiments_of
from hil.analysis.identification import Identification, identify, judge
from hil.analysis.identification._order import evaluate
from hil.core.channels import INPUT, OUTPUTS
from hil.core.errors import BadInputError
from hil.core.model import EffectUse, Model, load_model, model_from_dict
from hil.core.recording import Recording
from hil.plant import simulate
from reports.outputs.identification import output_files, summary_of, text_of
from test_plans import stimuli
from tests.benches_for_tests import SIM
from tests.hil.analysis import paper_plant
from tests.hil.analysis.conftest import exact, outputs_of

STEP = paper_plant.STEP_S
PERIOD_S = 10.0
_LINES = [n for i, n in enumerate(stimuli.multisine_lines(0.1, 30, PERIOD_S, odd_only=True)) if i % 4 != 3]
MULTISINE = stimuli.multisine(_LINES, PERIOD_S, 5, 0, STEP, rms=20.0, fade_s=0.5)
CHIRP = paper_plant.chirp(60.0)
Law = Callable[[np.ndarray], np.ndarray]


def recorded(torque: np.ndarray, acting: Law = lambda u: u, seen: Law = lambda y: y) -> Recording:
    """The paper's plant behind a law of the torque and before a law of the outputs, with 1 % of noise."""
    recording = paper_plant.recording(acting(torque))
    channels = {name: seen(recording[name]) for name in OUTPUTS}
    return replace(recording, channels={**recording.channels, **channels, INPUT: torque})


def identified(recording: Recording, order: int | None = 5) -> Identification:
    return identify(experiments_of(recording), order=order)


def with_backlash(half_gap_rad: float) -> Recording:
    model = load_model(SIM.simulation.model).with_effects(
        EffectUse("backlash", {"half_gap_rad": half_gap_rad})
    )
    channels = simulate(model, MULTISINE, STEP)
    time = np.arange(len(MULTISINE), dtype=np.float64) * STEP
    rng = np.random.default_rng(0)
    noisy = {n: channels[n] + 0.01 * np.std(channels[n]) * rng.standard_normal(len(time)) for n in OUTPUTS}
    return Recording({"time_s": time, INPUT: MULTISINE, **noisy}, Path("backlash.csv"))


@pytest.mark.slow
@pytest.mark.parametrize("torque", [CHIRP, MULTISINE], ids=["chirp", "multisine"])
@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_a_linear_axle_is_trusted_however_noisy(torque: np.ndarray, noise: float) -> None:
    found = identified(paper_plant.recording(torque, noise=noise))
    assert (found.verdict, found.warnings) == ("linear", ())
    assert [doubt[:17] for doubt in found.doubts] == ["the chain misses "]  # (14)-(16) belong to none
    assert "warning" not in found.model.meta


@pytest.mark.slow
def test_an_order_that_the_data_choose_is_trusted_too() -> None:
    for torque in (CHIRP, MULTISINE):
        assert identified(paper_plant.recording(torque), order=None).verdict == "linear"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: recorded(MULTISINE, acting=lambda u: u * np.abs(u) / 20), "nonlinear distortion"),
        (lambda: recorded(MULTISINE, acting=lambda u: np.clip(u, -8, 8)), "nonlinear distortion"),
        (
            lambda: recorded(MULTISINE, seen=lambda y: np.clip(y, -0.3 * np.std(y), 0.3 * np.std(y))),
            "misses the measured response",
        ),
        (lambda: with_backlash(0.02), "nonlinear distortion"),
        (lambda: recorded(CHIRP, acting=lambda u: u * np.abs(u) / 50), "cannot tell noise from nonlinearity"),
        (lambda: recorded(CHIRP, acting=lambda u: np.clip(u, -8, 8)), "cannot tell noise from nonlinearity"),
    ],
    ids=["square law", "saturation", "clipped sensors", "backlash", "square law, chirp", "saturation, chirp"],
)
def test_a_model_of_nonlinear_data_is_doubtful(make: Callable[[], Recording], said: str) -> None:
    found = identified(make())
    assert found.verdict == "doubtful"
    assert said in " ".join(found.warnings)


@pytest.mark.slow
def test_a_doubtful_model_says_so_wherever_it_goes() -> None:
    recording = recorded(MULTISINE, acting=lambda u: np.clip(u, -8, 8))
    experiments = experiments_of(recording)
    found = identify(experiments, order=5)
    files = output_files(found)
    for name in ("model.toml", "physical.toml"):
        model = model_from_dict(tomllib.loads(files[name].decode()), name)
        assert "nonlinear distortion" in model.meta["warning"]
        assert "standard_errors" not in model.meta
    summary = summary_of(found, experiments, sorted(files))
    assert summary["verdict"] == "doubtful"
    assert summary["warnings"] == list(found.warnings)
    assert summary["dead_time_s"]["standard_error"] is None
    assert summary["denominator"]["standard_errors"] is None
    lines = text_of(found, summary, Path("out")).splitlines()
    assert lines[0].startswith("WARNING: ")
    assert not any("±" in line for line in lines)
    json.dumps(summary["quality"], allow_nan=False)


def test_a_controller_of_a_doubtful_model_says_so(paper_model: Model) -> None:
    found = design(replace(paper_model, meta={"warning": "not linear"}), DesignSpec())
    assert found.warnings == ("the model is doubtful: not linear",)
    assert found.controller.meta["warnings"] == list(found.warnings)


@pytest.mark.parametrize("torque", [CHIRP, MULTISINE], ids=["chirp", "multisine"])
@pytest.mark.parametrize("walks", [False, True])
def test_outputs_that_have_nothing_to_do_with_the_input_are_refused(torque: np.ndarray, walks: bool) -> None:
    rng = np.random.default_rng(0)
    noise = {name: rng.standard_normal(len(torque)) for name in OUTPUTS}
    if walks:
        noise = {name: np.cumsum(values) for name, values in noise.items()}
    channels = {"time_s": np.arange(len(torque)) * STEP, INPUT: torque, **noise}
    with pytest.raises(BadInputError, match="coherence"):
        identified(Recording(channels, Path("noise.csv")))


def test_a_square_law_without_a_linear_part_is_refused() -> None:
    with pytest.raises(BadInputError, match="coherence"):
        identified(recorded(MULTISINE, acting=lambda u: u**2 / 20))


def test_an_input_that_rests_is_refused() -> None:
    recording = paper_plant.recording(CHIRP)
    recording.channels[INPUT] = np.full(len(CHIRP), 3.0)
    with pytest.raises(UnfitDataError, match="no excitation"):
        identified(recording)


@pytest.mark.parametrize("other", OUTPUTS)
def test_input_and_output_swapped_are_refused_or_doubted(other: str) -> None:
    recording = paper_plant.recording(CHIRP)
    c = recording.channels
    c[INPUT], c[other] = c[other], c[INPUT]
    try:
        found = identified(recording)
    except BadInputError:
        return
    assert found.verdict == "doubtful"
    assert "before the input acts" in " ".join(found.warnings)


def test_inverted_outputs_are_refused() -> None:
    with pytest.raises(BadInputError, match="looks inverted"):
        identified(recorded(CHIRP, seen=lambda y: -y))


def test_swapped_speeds_are_refused() -> None:
    recording = paper_plant.recording(CHIRP)
    c = recording.channels
    c[OUTPUTS[0]], c[OUTPUTS[1]] = c[OUTPUTS[1]], c[OUTPUTS[0]]
    with pytest.raises(BadInputError, match="look swapped"):
        identified(recording)


def test_a_fit_that_explains_less_than_half_is_refused() -> None:
    """An order far below that of a response with many resonances."""
    grid = exact(np.ones((3, 400), complex)).frequency_hz
    phase = np.random.default_rng(0).uniform(0, 2 * np.pi, (3, len(grid)))
    frf = exact(np.exp(1j * phase), 1e-3)
    with pytest.raises(BadInputError, match="less than half of its power"):
        judge(frf, evaluate(frf, 2, integrator=True))


def test_one_output_that_is_explained_is_enough_to_go_on() -> None:
    good = np.array(
        [paper_plant.response(name, exact(np.ones((3, 400), complex)).frequency_hz) for name in OUTPUTS]
    )
    good[2] = np.abs(good[2]) * np.exp(1j * np.random.default_rng(0).uniform(0, 2 * np.pi, 400))
    frf = outputs_of(exact(good, 1e-3), 3)
    found = judge(frf, evaluate(frf, 5, integrator=True))
    assert found.verdict == "doubtful"
    assert found.misfit[OUTPUTS[2]] > 0.5


def test_frequencies_of_comfort_without_coherence_are_said() -> None:
    frf = exact(
        np.array([paper_plant.response(n, exact(np.ones((3, 400), complex)).frequency_hz) for n in OUTPUTS])
    )
    taken = evaluate(frf, 5, integrator=True)
    assert judge(frf, taken).unseen == ()
    for dip_hz, said in ((10.0, True), (4.0, False), (25.0, False)):
        coherence = np.where(np.abs(frf.frequency_hz / dip_hz - 1) < 0.05, 0.4, 1.0)
        found = judge(replace(frf, coherence=np.tile(coherence, (3, 1))), taken)
        assert bool(found.unseen) == said
        assert all("below 0.5 at 9.5" in text and "8-20 Hz" in text for text in found.unseen)


@pytest.mark.slow
def test_an_identification_on_the_bench_says_where_wheel_orders_cover_the_input(tmp_path: Path) -> None:
    noise = 0.2 * np.sin(2 * np.pi * 10.0 * STEP * np.arange(len(CHIRP)))
    recording = paper_plant.recording(CHIRP)
    loud = {name: recording[name] + np.std(recording[name]) * 20 * noise for name in OUTPUTS}
    found = identified(replace(recording, channels={**recording.channels, **loud, INPUT: CHIRP}))
    assert any("8-20 Hz" in doubt for doubt in found.doubts)
    assert found.physical is not None
    assert found.physical.meta["band_hz"] == found.model.meta["band_hz"]
