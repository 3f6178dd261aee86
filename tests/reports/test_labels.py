from __future__ import annotations

import warnings

import pytest
from matplotlib.mathtext import MathTextParser

from hil.core.channels import CHANNELS
from reports.labels import (
    Label,
    channel_label,
    criterion_title,
    parameter_title,
    pieces,
    sentence_html,
    with_titles,
)


def test_symbols_become_subscripts() -> None:
    assert channel_label("motor_speed_rad_s").as_html() == "Motor speed <i>ω</i><sub>m</sub>"
    assert channel_label("driving_torque_est_nm").as_mathtext().endswith(r"$r\hat{F}_\mathrm{d}$")


@pytest.mark.parametrize("name", CHANNELS)
def test_matplotlib_can_set_every_symbol(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert MathTextParser("path").parse(channel_label(name).as_mathtext()).width > 0


def test_words_of_a_user_stay_words() -> None:
    label = Label("a <b> $x$", "T_s")
    assert label.as_html() == "a &lt;b&gt; $x$ <i>T</i><sub>s</sub>"
    assert label.as_mathtext() == r"a <b> \$x\$ $T_\mathrm{s}$"


def test_a_sentence_is_cut_at_known_symbols_only() -> None:
    text = "Peak of T_s, not of T_sum or x_y"
    assert [piece for piece, known in pieces(text) if known] == ["T_s"]
    assert "".join(piece for piece, _ in pieces(text)) == text
    assert sentence_html("T_s < 5") == "<i>T</i><sub>s</sub> &lt; 5"


def test_ids_of_criteria_and_channels_have_titles() -> None:
    assert criterion_title("a.peak_shaft_torque") == "Peak shaft torque, a"
    assert criterion_title("a.peak_shaft_torque.below.b") == "Peak shaft torque, a below b"
    assert criterion_title("own") == "own"
    assert with_titles("coherence of 'shaft_torque_nm' is low") == "coherence of shaft torque is low"
    assert with_titles("my_shaft_torque_nm") == "my_shaft_torque_nm"
    assert parameter_title("motor_inertia") == "motor inertia"
    assert parameter_title("backlash.half_gap_rad") == "backlash, half gap"
    assert parameter_title("motor_limits.power_w") == "motor limits, power"
    assert (
        parameter_title("shaft_cubic_stiffness.coefficient_nm_rad3") == "shaft cubic stiffness, coefficient"
    )
    assert parameter_title("running_resistance.aero_nms2_rad2") == "running resistance, aero"
    assert parameter_title("mount_mode.housing_inertia_kg_m2") == "mount mode, housing inertia"
