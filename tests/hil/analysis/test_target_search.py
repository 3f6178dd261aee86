"""What brings a predicted run to target figures: sizes, targets, search, conditions and what is reported."""

import itertools
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from hil.analysis.target_search import (
    Guess,
    Targets,
    Trial,
    candidates,
    conditions_of,
    explain,
    files_of,
    read_targets,
)
from hil.analysis.target_search._search import Search
from hil.analysis.target_search._separating import Separating
from hil.analysis.target_search._trial import Outcome
from hil.core.effects import EFFECTS, Stage
from hil.core.errors import BadInputError
from hil.core.files.toml_file import parse_toml
from hil.core.model import EffectUse, load_model, model_from_dict
from hil.engine import load_bench
from hil.engine.prediction.prediction import predict
from reports.target_search import caution, explanation_html, explanation_pdf
from tests.benches_for_tests import SIM, plan

BENCHES = Path(__file__).parents[3] / "benches"
BASE = load_model(BENCHES / "three_inertia.toml")
STEPS = """
  - set_controller: {file: gain_stabilization.toml}
  - step: {segment: s, quantity: driving_torque, from_nm: 0, to_nm: 326, before_s: 0.1, after_s: 0.7}
"""
CRITERIA = "[{segment: s, metric: peak_shaft_torque}]"
PEAK = "s.peak_shaft_torque"


def execute(checked, model, held):
    simulation = SIM.simulation.model_copy(update={"rmcu": dict(held)})
    return predict(checked, SIM.model_copy(update={"simulation": simulation}), model)


def targets(value, **changes):
    return Targets(plan(STEPS, CRITERIA), {PEAK: value}, **changes)


def test_every_plausible_size_is_within_its_declaration_and_no_sensor_is_among_them():
    found = candidates(BASE, 326.0, {"sigma": (0.5, 6.0)})
    assert found[0].id == "controller"
    ids = {candidate.id for candidate in found}
    assert {"backlash", "coulomb_friction", "wheel_order_disturbance", "tyre_slip"} <= ids
    for candidate in found[1:]:
        effect = EFFECTS[candidate.id]
        assert effect.stage not in (Stage.SENSOR, Stage.MODEL)
        for number in candidate.numbers:
            declared = effect.parameter(number.name)
            assert declared.lower <= number.low < number.high <= declared.upper
            assert number.at(0.0) == pytest.approx(number.low)
            assert number.at(1.0) == pytest.approx(number.high)


def test_a_ripple_is_at_most_a_third_of_the_torque_on_its_side():
    sizes = {c.id: {n.name: n for n in c.numbers} for c in candidates(BASE, 326.0, {})}
    assert sizes["wheel_order_disturbance"]["amplitude_nm"].high == pytest.approx(326 / 3)
    assert sizes["motor_order_ripple"]["amplitude_nm"].high == pytest.approx(326 / 3 / 8.148)


def test_a_guess_takes_the_place_of_an_effect_that_the_model_has():
    values = {"order": 4.0, "amplitude_nm": 50.0, "phase_rad": 0.0}
    model = Guess({"wheel_order_disturbance": values, "backlash": {"half_gap_rad": 0.01}}, {}).model(BASE)
    assert model.effects == (
        EffectUse("wheel_order_disturbance", {**values}),
        EffectUse("backlash", {"half_gap_rad": 0.01}),
    )


def test_the_base_model_at_its_own_figure_costs_nothing():
    trial = Trial(BASE, execute, targets(1.0))
    figure = trial.of(Guess({}, {})).figures[PEAK]
    assert figure is not None
    assert trial.of(Guess({}, {})).cost(targets(figure, first_seconds=0.7)) == pytest.approx(0.0)
    assert trial.of(Guess({}, {})).cost(targets(2.0 * figure)) == pytest.approx(
        1.0 + 10.0 * (np.log(2.0) / np.log(1.05) - 1.0)
    )


def test_a_guess_that_cannot_be_carried_out_has_no_figure_and_a_high_cost():
    trial = Trial(BASE, execute, targets(400.0))
    refused = Guess({}, {"wheel_radius": -1.0})
    outcome = trial.of(refused)
    assert outcome.figures == {PEAK: None}
    assert outcome.cost(trial.targets) == 1e4


def test_a_condition_at_its_limit_costs_as_much_as_a_figure_at_its_own_and_one_well_within_nothing():
    wanted = targets(400.0, settles={"s": 0.1})
    at: tuple[dict[str, float | None], dict[str, float | None]] = ({PEAK: 400.0}, {PEAK: None})
    assert Outcome(*at, {"a": 0.97}, {"s": 0.03}, {}).cost(wanted) == 0.0
    assert Outcome(*at, {"a": 1.0}, {"s": 0.05}, {}).cost(wanted) == pytest.approx(2.0)
    late = Outcome({PEAK: 400.0 * 1.05}, {PEAK: None}, {"a": 1.02}, {}, {})
    assert late.cost(wanted) == pytest.approx(1.0 + 11.0)


def test_where_a_figure_has_many_hollows_the_deepest_is_found():
    """One that no descent from the scattered guesses finds, with the looks that it has."""

    class Hollows:
        targets = None

        def of(self, guess):
            order = guess.effects["wheel_order_disturbance"]["order"]
            return SimpleNamespace(
                cost=lambda _: float(1.0 - np.cos(20.0 * (order - 4.4)) + (order - 4.4) ** 2)
            )

    ripple = next(c for c in candidates(BASE, 326.0, {}) if c.id == "wheel_order_disturbance")
    search = Search(cast("Trial", Hollows()), 300, 1, lambda text, share: None, lambda: False)
    search.execute((ripple,))
    assert search.best[0].cost < 1e-3
    assert search.done <= 310
    places = search.places((ripple,), 5)
    assert [one.cost for one in places] == sorted(one.cost for one in places)
    assert all(np.max(np.abs(a.point - b.point)) > 0.02 for a, b in itertools.combinations(places, 2))


@pytest.fixture(scope="module")
def found():
    wanted = targets(430.0, first_seconds=0.7, open={"k_i_dfc": (0.001, 0.01), "sigma": (0.5, 6.0)})
    return explain(BASE, execute, wanted, evaluations=60, seed=1)


@pytest.mark.slow
def test_a_figure_that_can_be_reached_is_reached(found):
    best = found.rivals[0]
    assert found.reached
    assert not best.missed
    assert best.outcome.figures[PEAK] == pytest.approx(430.0, rel=0.05)
    assert found.base.missed
    assert "controller" in {name for rival in found.rivals for name in rival.names}


@pytest.mark.slow
def test_the_same_seed_gives_the_same_rivals(found):
    again = explain(BASE, execute, found.targets, evaluations=60, seed=1)
    assert [r.guess for r in again.rivals] == [r.guess for r in found.rivals]


@pytest.mark.slow
def test_what_was_found_can_be_used(found):
    files = files_of(found)
    for number, rival in enumerate(found.rivals, 1):
        text = files[f"rival_{number}.toml"].decode()
        model = model_from_dict(parse_toml(text, "rival"), "rival")
        assert [use.id for use in model.effects] == [use.id for use in rival.model.effects]
        for name in rival.guess.held:
            assert f"#   {name} = " in text
    assert (
        b"set_controller" in files["separating_plan.yaml"] or b"motor_torque" in files["separating_plan.yaml"]
    )
    assert "does not single out" in caution(found)
    page = explanation_html(found)
    assert page.count("<figure") == 2  # on top and among the responses
    assert explanation_pdf(found).startswith(b"%PDF")


@pytest.mark.slow
def test_stopped_at_once_it_tells_what_it_knows():
    asked = iter([False] * 3)
    wanted = targets(430.0)
    found = explain(BASE, execute, wanted, evaluations=60, stopped=lambda: next(asked, True))
    assert (found.interrupted, found.evaluations) == (True, 3)
    assert len(found.rivals) >= 1


def test_nothing_found_is_said():
    found = explain(BASE, execute, targets(430.0), evaluations=60, stopped=lambda: True)
    assert found.rivals == ()
    assert not found.reached
    assert found.verdict == "No run was predicted."
    assert "Not reached" in explanation_html(found)


def test_the_shipped_targets_are_the_papers():
    wanted = read_targets(BENCHES / "paper_targets.toml", None, {})
    assert sorted(wanted.values.values()) == [534.0, 564.0, 723.0]
    assert wanted.response is not None
    base = Trial(BASE, execute, wanted).misfit(BASE)
    for name, limits in wanted.response.within.items():
        assert all(value <= limit for value, limit in zip(base[name], limits, strict=True))


def _numbers(use):
    return {name: value for name, value in use.values.items() if not isinstance(value, str)}


@pytest.mark.slow
def test_the_bench_of_the_papers_car_holds_every_condition():
    """Its own numbers as a guess: the whole acceptance plan and an identification run."""
    bench = load_bench("paper_car")
    wanted = read_targets(BENCHES / "paper_targets.toml", None, {})
    axle = load_model(bench.simulation.model)
    assert axle.parameters == BASE.parameters
    guess = Guess({use.id: _numbers(use) for use in axle.effects}, bench.simulation.rmcu)
    trial = Trial(BASE, execute, wanted)
    conditions = conditions_of(guess, trial.of(guess), trial)
    assert len(conditions) == 17
    assert [condition for condition in conditions if not condition.holds] == []


@pytest.mark.parametrize(
    ("text", "further", "said"),
    [
        ("", {"gain_0kmh.peak_shaft_torqe": 534.0}, "did you mean 'gain_0kmh.peak_shaft_torque'?"),
        ("", {"gain_0kmh.peak_shaft_torque": -1.0}, "is -1"),
        ("", {}, "no target is given"),
        ("tolerence = 0.1", {}, "did you mean 'tolerance'?"),
        ("tolerance = 'a'", {}, "tolerance: "),
        ("[targets]\n'x' = 1.0", {}, "no criterion has the name 'x'"),
        (
            "[targets]\n'gain_0kmh.peak_shaft_torque' = 1.0\n[open]\nsigma = [2.0, 1.0]",
            {},
            "open.sigma runs from 2 to 1",
        ),
        (
            "[targets]\n'gain_0kmh.peak_shaft_torque' = 1.0\n[settles]\nphase_0kmhh = 1.0",
            {},
            "did you mean 'phase_0kmh'?",
        ),
    ],
)
def test_wrong_targets_are_one_message(tmp_path, text, further, said):
    path = tmp_path / "targets.toml"
    path.write_text(text)
    with pytest.raises(BadInputError) as caught:
        read_targets(path if text else None, "acceptance", further)
    assert said in str(caught.value)


def test_a_plan_without_steps_can_be_explained_and_one_without_torque_says_so():
    chirp = """
  - chirp: {segment: s, quantity: motor_torque, from_hz: 1, to_hz: 30, duration_s: 2, amplitude_nm: 10}
"""
    aimed = Targets(plan(chirp, CRITERIA), {PEAK: 90.0})
    found = explain(BASE, execute, aimed, evaluations=20, among=("dead_time",))
    assert found.rivals
    still = BASE.with_effects(EffectUse("torque_deadband", {"half_width_nm": 50.0}))
    with pytest.raises(BadInputError, match="applies no torque"):
        explain(still, execute, aimed, evaluations=20)


def test_what_is_no_step_does_not_settle(tmp_path):
    text = "name: p\nsteps:\n  - chirp: {segment: c, quantity: motor_torque, from_hz: 1, to_hz: 30, "
    text += "duration_s: 2, amplitude_nm: 10}\ncriteria: [{segment: c, metric: peak_shaft_torque}]\n"
    (tmp_path / "p.yaml").write_text(text)
    (tmp_path / "t.toml").write_text("[targets]\n'c.peak_shaft_torque' = 1.0\n[settles]\nc = 1.0")
    with pytest.raises(BadInputError, match="is not a step"):
        read_targets(tmp_path / "t.toml", str(tmp_path / "p.yaml"), {})


def test_the_run_that_tells_two_apart_says_by_how_much_in_a_unit() -> None:
    test = Separating("", "a step", 3e5, {"shaft_torque_nm": 12.345, "motor_speed_rad_s": 6100.0})
    assert test.in_words() == "6100 rad/s rms in motor_speed_rad_s"
    assert replace(test, differs={**test.differs, "motor_speed_rad_s": 0.01}).in_words() == (
        "12.3 N m rms in shaft_torque_nm"
    )
