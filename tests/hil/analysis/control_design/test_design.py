from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hil.analysis.control_design import (
    Design,
    DesignSpec,
    MarginLimits,
    design,
    measured_loop,
    optimize,
)
from hil.analysis.identification import Identification
from hil.core.controller import controller_from_toml, controller_to_toml
from hil.core.errors import BadInputError
from hil.core.model import Model
from reports.outputs.control_design import summary_of, text_of
from tests.hil.analysis.identification.chains import THREE, TWO


def test_controller_of_the_paper(paper_design: Design) -> None:
    controller = paper_design.controller
    assert controller.stabilization == "phase"
    assert controller.wsc.proportional_gain == pytest.approx(2.6775)
    assert controller.wsc.integral_gain == pytest.approx(0.4016, abs=5e-5)
    assert controller.wsc.lead is not None
    assert controller.wsc.lead.alpha == pytest.approx(0.25962, abs=5e-6)
    assert controller.dfc.integral_gain == 0.001
    assert controller.dfo.time_constant_s == pytest.approx(1 / 125.6)
    assert controller.dfo.gear_ratio == pytest.approx(8.148, abs=5e-4)
    assert controller.dfo.wheel_inertia_kg_m2 == pytest.approx(4.355, rel=0.01)
    assert controller_from_toml(controller_to_toml(controller), "again") == controller


def test_a_half_gap_adds_a_crossing_of_the_models_own_shafts() -> None:
    chain = Model("three_inertia", THREE)
    found = design(chain, DesignSpec(half_gap_rad=0.01)).controller
    assert design(chain, DesignSpec()).controller == found.model_copy(update={"play": None})
    assert found.play is not None
    assert found.play.half_gap_rad == 0.01
    for key, name in (
        ("shaft_stiffness_nm_rad", "shaft_stiffness"),
        ("tyre_damping_nms_rad", "tyre_damping"),
        ("vehicle_inertia_kg_m2", "vehicle_inertia"),
        ("dead_time_s", "torque_delay"),
    ):
        assert getattr(found.play, key) == pytest.approx(THREE[name]), key
    assert controller_from_toml(controller_to_toml(found), "again") == found


def test_of_functions_the_crossing_has_the_nearest_chain(paper_model: Model) -> None:
    play = design(paper_model, DesignSpec(half_gap_rad=0.01)).controller.play
    assert play is not None
    assert play.shaft_stiffness_nm_rad == pytest.approx(THREE["shaft_stiffness"], rel=0.1)


def test_phase_beats_gain_at_the_resonance_and_loses_around_thirty_hertz(paper_design: Design) -> None:
    """The paper's statement on Figs. 11 and 12."""
    frequency = paper_design.frequency_hz

    def sensitivity(name: str, at_hz: float) -> float:
        return float(1 / abs(1 + np.interp(at_hz, frequency, paper_design.loop(name).sampled)))

    assert sensitivity("phase", 10.6) < 0.6 * sensitivity("gain", 10.6)
    assert paper_design.loop("phase").margins.sensitivity_peak_hz > 30
    assert abs(np.angle(np.interp(10.6, frequency, paper_design.loop("phase").sampled), deg=True)) < abs(
        np.angle(np.interp(10.6, frequency, paper_design.loop("pi").sampled), deg=True)
    )


def test_hold_costs_half_a_sample_of_phase(paper_design: Design) -> None:
    loop = paper_design.loop("pi")
    row = int(np.argmin(np.abs(paper_design.frequency_hz - 10.0)))
    turn = np.angle(loop.sampled[row] / loop.continuous[row], deg=True)
    assert turn == pytest.approx(-360 * 10.0 * 0.0005, abs=0.1)


def test_optimum_beats_the_papers_lead(paper_design: Design, optimised_design: Design) -> None:
    best, paper = optimised_design.loop("phase").margins, paper_design.loop("phase").margins
    assert best.comfort_peak < 0.85 * paper.comfort_peak
    assert best.stable
    limits = MarginLimits()
    worst = optimised_design.robustness
    assert worst.stable_share == 1.0
    assert worst.sensitivity_peak <= limits.sensitivity_peak * 1.006
    assert worst.gain_margin_db >= limits.gain_margin_db * 0.994
    assert worst.phase_margin_deg >= limits.phase_margin_deg * 0.994
    assert worst.delay_margin_s >= limits.delay_margin_s * 0.994


def test_impossible_limits_are_refused(paper_design: Design) -> None:
    frequency = paper_design.frequency_hz[::5]
    plant = paper_design.loop("plant").sampled[None, ::5]
    with pytest.raises(BadInputError, match="no lead keeps"):
        optimize(frequency, plant, 4.5, 0.001, limits=MarginLimits(sensitivity_peak=1.01))


def test_rms_is_another_objective(paper_design: Design) -> None:
    frequency = paper_design.frequency_hz[::5]
    plant = paper_design.loop("plant").sampled[None, ::5]
    found = [optimize(frequency, plant, 4.5, 0.001, objective=o) for o in ("max", "rms")]
    assert found[1].objective < found[0].objective
    assert found[1].objective < paper_design.loop("phase").margins.comfort_rms


def test_identified_uncertainty_is_used(paper_identification: Identification) -> None:
    found = design(paper_identification.model, DesignSpec())
    assert "fit's covariance" in found.robustness.source
    assert found.robustness.sensitivity_peak == pytest.approx(
        found.loop("phase").margins.sensitivity_peak, rel=0.02
    )
    points = measured_loop(found, paper_identification.frf)
    expected = np.interp(
        paper_identification.frf.frequency_hz, found.frequency_hz, found.loop("phase").sampled
    )
    assert np.median(np.abs(points["phase"] / expected - 1)) < 0.01


def test_physical_chain_is_accepted() -> None:
    found = design(Model("three_inertia", THREE), DesignSpec())
    assert found.controller.dfo.wheel_inertia_kg_m2 == THREE["wheel_inertia"]
    assert found.loop("phase").margins.stable


def test_two_inertias_need_the_wheels_inertia() -> None:
    with pytest.raises(BadInputError, match="inertia of the wheels"):
        design(Model("two_inertia", TWO), DesignSpec())
    found = design(Model("two_inertia", TWO), DesignSpec(wheel_inertia_kg_m2=4.0))
    assert found.controller.dfo.wheel_inertia_kg_m2 == 4.0


def test_notch_instead_of_lead(paper_model: Model) -> None:
    found = design(paper_model, DesignSpec(stabilisation="gain", notch_hz=10.6))
    assert found.controller.stabilization == "gain"
    assert found.controller.wsc.notch is not None
    assert "notch" in found.discrete


@pytest.mark.parametrize(
    "choice",
    [
        {"pole_rad_s": 3.0},
        {"pole_rad_s": 10.0, "stabilisation": "gain"},
        {"lead_deg": 80.0, "normalisation": "dc"},
    ],
)
def test_an_unstable_loop_is_refused_with_what_was_found(
    paper_model: Model, choice: dict[str, object]
) -> None:
    spec = replace(DesignSpec(), **choice)  # type: ignore[arg-type]
    with pytest.raises(BadInputError) as caught:
        design(paper_model, spec)
    assert "closed loop is unstable" in caught.value.what
    assert "outside the unit circle, the worst at" in caught.value.what
    assert "|S|max" in caught.value.what
    assert "--pole" in caught.value.fix
    compared = design(paper_model, spec, unstable_too=True)
    assert not compared.loop(spec.stabilisation).margins.stable


def test_a_good_loop_has_no_warnings(paper_design: Design, optimised_design: Design) -> None:
    assert paper_design.warnings == optimised_design.warnings == ()
    assert paper_design.controller.meta == {}


def test_a_poor_loop_is_handed_out_with_warnings_first(paper_model: Model) -> None:
    found = design(paper_model, DesignSpec(pole_rad_s=0.7))
    assert found.loop("phase").margins.stable
    summary = summary_of(found, None, "model.toml", [])
    assert summary["warnings"] == list(found.warnings)
    assert any("|S|max is" in w for w in found.warnings)
    lines = text_of(found, None, Path("out")).splitlines()
    assert lines[: len(found.warnings)] == [f"WARNING: {w}" for w in found.warnings]
    again = controller_from_toml(controller_to_toml(found.controller), "again")
    assert again.meta["warnings"] == list(found.warnings)


def test_a_loop_that_the_uncertainty_upsets_says_so(paper_model: Model) -> None:
    found = design(paper_model, DesignSpec(pole_rad_s=1.1))
    assert found.robustness.stable_share < 1
    assert any("unstable for" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("option", "change"),
    [
        *(("--pole", {"pole_rad_s": v}) for v in (0.0, -1.0, np.nan, np.inf, 1e9)),
        *(("--lead-deg", {"lead_deg": v}) for v in (0.0, -5.0, 90.0, np.nan, np.inf)),
        *(("--lead-hz", {"lead_hz": v}) for v in (0.0, -5.0, 500.0, 5000.0, np.nan, np.inf)),
        *(("--notch-hz", {"notch_hz": v, "stabilisation": "gain"}) for v in (0.0, 500.0, 5000.0, np.nan)),
        *(("--notch-width", {"notch_width": v}) for v in (0.0, -1.0, np.inf, np.nan)),
        *(("--notch-depth", {"notch_depth": v}) for v in (-0.1, 1.1, np.nan)),
        *(("--torque-limit", {"torque_limit_nm": v}) for v in (0.0, -1.0, np.nan, np.inf)),
        *(("--inertia", {"inertia_kg_m2": v}) for v in (0.0, -1.0, np.nan, np.inf)),
        *(("--gear-ratio", {"gear_ratio": v}) for v in (0.0, -1.0, np.nan)),
        *(("--wheel-inertia", {"wheel_inertia_kg_m2": v}) for v in (0.0, -1.0, np.inf)),
        *(
            ("--largest-sensitivity", {"limits": MarginLimits(sensitivity_peak=v)})
            for v in (0.0, 1.0, -2.0, np.nan, np.inf)
        ),
        ("sample_time_s", {"sample_time_s": 0.0}),
    ],
)
def test_a_value_out_of_range_is_refused_with_option_and_range(
    paper_model: Model, option: str, change: dict[str, object]
) -> None:
    with pytest.raises(BadInputError) as caught:
        design(paper_model, replace(DesignSpec(), **change))  # type: ignore[arg-type]
    assert option in caught.value.what
    assert any(word in caught.value.fix for word in ("positive", "above", "lies from"))


def test_a_notch_that_the_sampling_rate_cannot_reach_is_refused() -> None:
    stiff = THREE | {"shaft_stiffness": 5e8, "shaft_damping": 1.0}
    with pytest.raises(BadInputError, match="half the RMCU's sampling rate"):
        design(Model("three_inertia", stiff), DesignSpec(stabilisation="gain"))


def test_trade_off_rises_with_the_phase(paper_design: Design) -> None:
    chart = paper_design.trade_off
    at_forty = int(np.flatnonzero(chart.frequencies_hz == 40)[0])
    assert np.all(np.diff(chart.phase_deg[:, at_forty]) > 0)
    assert chart.sensitivity_peak.shape == chart.phase_deg.shape


@pytest.mark.parametrize(("stiffness", "said"), [(1e12, "diverges"), (1e8, "Hz lies above 500 Hz")])
@pytest.mark.parametrize("stabilisation", ["phase", "gain"])
def test_a_model_that_no_control_can_act_on_is_refused_with_its_file(stiffness, said, stabilisation):
    model = Model("three_inertia", {**THREE, "shaft_stiffness": stiffness}, source="mine.toml")
    with pytest.raises(BadInputError, match=said) as refused:
        design(model, DesignSpec(stabilisation=stabilisation))
    assert refused.value.where == "mine.toml"


def test_what_lies_outside_of_the_data_is_said(paper_model: Model) -> None:
    peak_hz = design(paper_model, DesignSpec()).loop("phase").margins.sensitivity_peak_hz
    assert 30 < peak_hz < 100
    for band, said in (([0.05, 30.0], True), ([1e-3, 400.0], False), (["x", 30.0], False), (None, False)):
        found = design(replace(paper_model, meta={} if band is None else {"band_hz": band}), DesignSpec())
        notes = [note for note in found.notes if "outside of the data" in note]
        assert bool(notes) == said
        assert all(f"|S|max at {peak_hz:.3g} Hz" in note for note in notes)


def test_a_chain_is_drawn_from_its_standard_errors() -> None:
    assert "carries no uncertainty" in design(Model("three_inertia", THREE), DesignSpec()).robustness.source
    peaks = []
    for share in (1e-6, 0.05):
        stated = {"standard_errors": {name: share * value for name, value in THREE.items()}}
        found = design(Model("three_inertia", THREE, meta=stated), DesignSpec())
        assert "the chain's standard errors" in found.robustness.source
        peaks.append(found.robustness.sensitivity_peak / found.loop("phase").margins.sensitivity_peak)
    assert peaks[0] == pytest.approx(1.0, rel=1e-2)
    assert peaks[1] > 1.02
