"""The file of free parameters: the shipped one is valid, and every mistake is named."""

import pytest

from hil.analysis.tuning import free_from_toml, read_free, refuse_unknown_weights
from hil.core.errors import BadInputError
from tests.hil.analysis.tuning.trials import trial_of


def test_the_shipped_file_frees_lead_pole_and_filters():
    free = read_free(None)
    assert {"lead_deg", "lead_hz", "pole_rad_s", "feed_forward_time_s"} <= set(free.free)
    assert free.limits.sensitivity_peak == 2.0
    assert free.tolerance.relative["tyre_stiffness"] == 0.2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "free: is missing"),
        ("[free]\n", "free"),
        ("[free]\nlead_dg = [0, 1]\n", "did you mean 'lead_deg'?"),
        ("[free]\nlead_deg = [10, 5]\n", "the lower bound is not below the upper one"),
        ("[free]\nlead_deg = [0, 95]\n", "it lies from 0 to 85"),
        ("[free]\nlead_deg = [0, nan]\n", "lead_deg"),
        ("[free]\nlead_deg = [0, 1]\nnotch_hz = [5, 20]\n", "exclude each other"),
        ("[free]\npole_rad_s = [0.1, 1]\nintegral_gain = [0.1, 1]\n", "exclude each other"),
        ("[free]\nlead_deg = [0, 1]\n[limits]\nsensitivity_peak = 0.9\n", "limits.sensitivity_peak"),
        ("[free]\nlead_deg = [0, 1]\n[limits]\nsensitivity = 2\n", "unknown key"),
        ("[free]\nlead_deg = [0, 1]\n[weights]\nx = 0\n", "above 0"),
        ("[free]\nlead_deg = [0, 1]\n[tolerance]\nvehicle_inertia = 1.5\n", "below 1"),
        ("[free]\nlead_deg = [0, 1]\n[tolerance]\nmass = 0.1\n", "unknown key"),
        ("[free]\nlead_deg = [0, '1']\n", "line 2"),
        ("[free]\nlead_deg = [0, 1]\n[tolerance]\nvehicle_inertia = '0.1'\n", "line 4"),
        ("where = 'x'\n[free]\nlead_deg = [0, 1]\n", "unknown key"),
        ("free = 3\n", "free"),
        ("[free\n", "not a TOML file"),
    ],
)
def test_mistakes_are_named_with_the_file(text, said):
    with pytest.raises(BadInputError) as refused:
        free_from_toml(text, "mine.toml")
    assert said in str(refused.value)
    assert "mine.toml" in str(refused.value)


def test_a_weight_of_nothing_is_refused():
    trial = trial_of()
    weighted = free_from_toml("[free]\nlead_deg = [0, 1]\n[weights]\npeak_shaft_torqe = 2\n", "f.toml")
    with pytest.raises(BadInputError, match="did you mean 'peak_shaft_torque'"):
        refuse_unknown_weights(weighted, trial.plan)


def test_a_criterion_has_the_weight_of_its_id_or_of_its_metric():
    free = free_from_toml("[free]\nlead_deg = [0, 1]\n[weights]\npeak = 2\n'a.peak' = 3\n", "f.toml")
    assert [free.weight(*names) for names in (("a.peak", "peak"), ("b.peak", "peak"), ("c", "d"))] == [
        3,
        2,
        1,
    ]
