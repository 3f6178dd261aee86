"""The report of a diagnosis: what it says, and that both forms of it are whole."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import html
from pypdf import PdfReader

from hil.analysis.diagnosis import (
    BANDS_HZ,
    CONDITIONS,
    Alternative,
    ChannelGap,
    Curve,
    Diagnosis,
    GapMap,
    NamedEffect,
    Overlay,
    Where,
)
from hil.core.channels import OUTPUTS
from hil.core.model import EffectUse, Model, load_model
from reports.diagnosis import diagnosis_html, diagnosis_pdf
from reports.diagnosis_content import first, headline, lead, parts
from reports.diagnosis_figures import overlay_figures
from reports.diagnosis_steps import next_steps
from reports.figure import Figure
from reports.outputs.autotune import effects_in_words

MODEL = load_model(Path(__file__).parents[2] / "benches/three_inertia.toml")
MOTOR, WHEEL, SHAFT = OUTPUTS
SKEW = EffectUse("channel_skew", {"channel": MOTOR, "delay_s": 0.002})


def _map(level: float) -> GapMap:
    bands = np.full((2, 3, len(BANDS_HZ)), level)
    bands[:, 1] = np.nan
    conditions = np.full((len(CONDITIONS), 3), level)
    conditions[0, 0] = np.nan
    conditions[:, 1] = np.nan
    return GapMap(("one <b>", "two"), bands, conditions)


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """Backlash named; no wheel speed measured; one recording held out."""
    t = np.arange(3000) * 1e-3
    swing = np.column_stack([np.sin(20 * t), np.full(3000, np.nan), 50 * np.sin(20 * t)])
    place = Where((MOTOR, SHAFT), (6.0, 14.0), "torque reversals")
    use = EffectUse("backlash", {"half_gap_rad": 0.0198})
    gaps = {c: (ChannelGap(0.3, 0.02), ChannelGap(0.021, 0.02)) for c in (MOTOR, SHAFT)}
    before, after = ({c: pair[i] for c, pair in gaps.items()} for i in (0, 1))
    return Diagnosis(
        verdict="named",
        base=MODEL,
        model=MODEL,
        effects=(NamedEffect(use, {"half_gap_rad": 2e-4}, 0.97, place),),
        parameter_updates={"vehicle_inertia": (303.0, 301.7, 0.4)},
        alternatives=(
            Alternative(
                SKEW, 0.03, "A chirp up to 30 Hz.", "separate_channel_skew.yaml", "name: x", "backlash"
            ),
        ),
        gap_before=before,
        gap_after=after,
        holdout_before=before,
        holdout_after=after,
        map_before=_map(500.0),
        map_after=_map(1.0),
        signature="",
        overlays=(Overlay("one", 1e-3, np.zeros(3000), swing, 0.5 * swing, 0.99 * swing),),
        notes=("one: cut at gaps: 1",),
        consequences={
            "overshoot_shaft_torque_percent": {"before": 50.0, "after": 60.0, "after_standard_error": 1.234}
        },
    )


def test_the_page_says_what_was_found_and_links_to_every_section(found: Diagnosis) -> None:
    page: Any = html.fromstring(diagnosis_html(found, "axle <i>.toml"))
    text = " ".join(page.text_content().split())
    for said in (
        "axle <i>.toml",
        "Named: backlash",
        "97%",
        "one <b>",
        "cut at gaps: 1",
        "held-out recordings",
        "60.002.4",
        "On held-out recordings the model after closes 99.6 % of the largest gap: motor speed is 30.00 %",
    ):
        assert said in text
    assert "channel_skew (motor_speed_rad_s)" in text
    assert "separate_channel_skew.yaml" in text
    links = [a.get("href").removeprefix("#") for a in page.xpath("//nav//a")]
    assert links == [part.id for part in parts(found)]
    assert all(page.get_element_by_id(link).tag == "section" for link in links)
    assert len(page.xpath("//figure/img[starts-with(@src, 'data:image/svg+xml') and @alt]")) == 1
    assert len(page.xpath("//figure/div[@class='plot' and @aria-label]")) == 7
    assert not page.xpath("//script[@src] | //link")


def test_maps_stand_in_pairs_and_shade_what_is_above_the_noise(found: Diagnosis) -> None:
    (maps,) = (part.maps for part in parts(found) if part.maps)
    assert [m.title for m in maps] == [
        "Motor speed, before",
        "Motor speed, after",
        "Shaft torque, before",
        "Shaft torque, after",
        "Operating conditions, before",
        "Operating conditions, after",
    ]
    shades = [{cell.shade for _, cells in m.rows for cell in cells} for m in maps[:4]]
    assert shades == [{1.0}, {0.0}, {1.0}, {0.0}]
    assert maps[4].rows[0][1][0].text == "–"
    assert [name for name, _ in maps[4].rows] == ["Motor speed", "Shaft torque"]


def test_headline_and_lead_follow_the_verdict(found: Diagnosis) -> None:
    assert lead(found).endswith("30.00 % of its signal off before, 2.10 % after; noise is 2.00 %.")
    none = dataclasses.replace(found, verdict="none", effects=())
    assert headline(none) == "The model explains the data to the noise"
    assert "as it came" not in lead(none)
    unknown = dataclasses.replace(found, verdict="unknown", effects=(), signature="a line at 13 Hz")
    assert headline(unknown) == "A gap that no known effect closes"
    assert "a line at 13 Hz" in lead(unknown)


def test_the_pdf_is_archivable_and_says_the_same(found: Diagnosis) -> None:
    pdf = diagnosis_pdf(found, "A title with 軸")
    reader = PdfReader(io.BytesIO(pdf))
    assert "pdfaid" in str(reader.xmp_metadata.stream.get_data())
    text = " ".join(" ".join(page.extract_text().split()) for page in reader.pages)
    for said in ("Named: backlash", "Motor speed, before", "Alternative explanations", "U+8EF8"):
        assert said in text


def test_a_report_without_effects_or_held_out_data_is_whole_too(found: Diagnosis) -> None:
    bare = dataclasses.replace(
        found,
        verdict="unknown",
        effects=(),
        parameter_updates={},
        alternatives=(),
        holdout_before={},
        holdout_after={},
        signature="it lies between 1 and 3 Hz",
    )
    assert "held-out" not in diagnosis_html(bare, "t")
    assert diagnosis_pdf(bare, "t").startswith(b"%PDF")


def test_a_recording_shorter_than_the_window_is_drawn_whole(found: Diagnosis) -> None:
    swing = np.sin(np.arange(200) / 20)[:, None] * np.ones(3)
    short = Overlay("short", 1e-3, np.zeros(200), swing, 0.5 * swing, 0.99 * swing)
    figures = overlay_figures(short)
    assert [len(trace.x) for trace in figures[0].traces] == [200, 200, 200]


def test_why_no_step_is_judged_is_of_this_model(found: Diagnosis) -> None:
    """No consequences alone do not mean that the load is recorded."""
    rigid = Model("rigid", {"motor_inertia": 0.05, "gear_ratio": 9.0, "vehicle_inertia": 300.0})
    for model, said in ((MODEL, ""), (rigid, "The model's axle is rigid")):
        bare = dataclasses.replace(found, model=model, consequences={})
        (part,) = (one for one in parts(bare) if one.id == "consequences")
        assert part.text.startswith(said)
        assert "recordings" not in part.text


def test_gaps_over_next_to_no_noise_have_no_digits_that_mean_nothing(found: Diagnosis) -> None:
    """Recordings of a simulation have hardly any noise."""
    bare = {c: ChannelGap(0.3, 1e-9) for c in (MOTOR, SHAFT)}
    shown = dataclasses.replace(
        found,
        gap_before=bare,
        gap_after=bare,
        holdout_after={},
        holdout_before={},
    )
    assert "30.00 % after; noise is 1e-07 %" in lead(shown)
    text = {part.id: part for part in parts(shown)}
    assert "e+" not in " ".join(cell for table in text["gap"].tables for row in table.rows for cell in row)


def test_measured_is_drawn_over_what_was_simulated(found: Diagnosis) -> None:
    (overlays,) = (part.figures for part in parts(found) if part.id == "overlays")
    shown = [figure for figure in overlays if isinstance(figure, Figure) and figure.id.startswith("time-")]
    assert shown
    assert all(figure.traces[-1].label.text == "measured" for figure in shown)


def test_the_first_screen_answers_what_is_missing_and_how_much_it_closes(found: Diagnosis) -> None:
    at = np.linspace(-0.1, 0.1, 24)
    play = Curve("backlash", "twist in rad", at, 6000.0 * at, 6000.0 * at, 0.99)
    part = first(dataclasses.replace(found, curves=(play,)))
    assert [table.head[0] for table in part.tables] == ["effect", "held-out recordings"]
    curve, overlay = part.figures
    assert isinstance(curve, Figure)
    assert isinstance(overlay, Figure)
    assert (curve.title.text, curve.x_title) == ("Backlash: torque over twist", "Twist (rad)")
    assert [trace.label.text for trace in curve.traces] == ["its law", "measured"]
    assert [trace.label.text for trace in overlay.traces] == ["model after", "model before", "measured"]


def test_what_stays_without_a_name_is_drawn_without_a_law(found: Diagnosis) -> None:
    at = np.linspace(0.0, 6.0, 24)
    stays = Curve("", "angle within a turn in rad", at, np.sin(at), None, 0.9)
    changed = dataclasses.replace(found, verdict="unknown", effects=(), curves=(stays,))
    curve = first(changed).figures[0]
    assert isinstance(curve, Figure)
    assert curve.title.text == "What stays without a name: torque over angle within a turn"
    assert len(curve.traces) == 1
    assert ("Look at the torque that stays: it follows angle within a turn in rad") in str(
        next_steps(changed)
    )


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, ("Tell backlash from channel skew", "hil run separate_channel_skew.yaml, then diagnose again")),
        ({}, ("Go on with the new model", "hil tune PLAN --model model.toml")),
        ({"holdout_after": {}}, ("Hold a recording back", "--holdout RECORDING")),
        ({"open_channels": (SHAFT,)}, ("Record more: more than noise stays in shaft torque", "coast-down")),
        ({"held_out_open": (SHAFT,)}, ("Give the held-out recordings as recordings too", "--holdout")),
        ({"unfinished": "interrupted"}, ("Let the search end", "--at-most MINUTES")),
        ({"verdict": "unknown", "effects": ()}, ("Find out whether it is channel skew", "hil run separate")),
        (
            {"model": dataclasses.replace(MODEL, load_input="wheel_speed_rad_s")},
            ("Go on", "hil simulate --model"),
        ),
        ({"verdict": "unknown", "effects": ()}, ("Look where the gap is", "chirps at two amplitudes")),
    ],
)
def test_the_report_says_what_to_do_next(
    found: Diagnosis, changes: dict[str, Any], said: tuple[str, str]
) -> None:
    steps = next_steps(dataclasses.replace(found, **changes)).rows
    assert any(what.startswith(said[0]) and said[1] in how for what, how in steps), steps


def test_a_name_is_never_quite_certain(found: Diagnosis) -> None:
    sure = dataclasses.replace(found.effects[0], confidence=0.9999)
    assert "(>99%)" in effects_in_words(dataclasses.replace(found, effects=(sure,)))


def test_a_rival_is_told_from_the_name_that_it_would_take_the_place_of(found: Diagnosis) -> None:
    friction = dataclasses.replace(found.effects[0], use=EffectUse("coulomb_friction", {"torque_nm": 1.0}))
    rival = dataclasses.replace(found.alternatives[0], instead_of="coulomb_friction")
    two = dataclasses.replace(found, effects=(*found.effects, friction), alternatives=(rival,))
    page: Any = html.fromstring(diagnosis_html(two, "axle.toml"))
    words = " ".join(page.text_content().split())
    assert "Tell coulomb friction from" in words
    assert "Tell backlash from" not in words


def test_names_that_the_data_cannot_tell_apart_stand_together_and_share_the_confidence(
    found: Diagnosis,
) -> None:
    use = EffectUse("running_resistance", {"rolling_nm": 3.0, "aero_nms2_rad2": 0.01})
    other = EffectUse("sensor_lag", {"channel": MOTOR, "time_constant_s": 0.01})
    named = dataclasses.replace(
        found.effects[0], use=use, confidence=0.9, alike=("sensor_lag(motor_speed_rad_s)",)
    )
    doubt = dataclasses.replace(
        found,
        effects=(named,),
        alternatives=(Alternative(other, 0.9, "A coast-down."), Alternative(SKEW, 0.04, "A chirp.")),
    )
    content = doubt.as_json()
    names = "running_resistance or sensor_lag(motor_speed_rad_s)"
    assert content["effects"][0]["class"] == content["alternatives"][0]["class"] == names
    assert "class" not in content["alternatives"][1]
    assert content["something_else"] == pytest.approx(0.06)
    assert found.as_json()["something_else"] == pytest.approx(0.0)
    page: Any = html.fromstring(diagnosis_html(doubt, "axle.toml"))
    assert "Named: running resistance or sensor lag of motor speed" in " ".join(page.text_content().split())


def test_errors_of_all_sensors_are_said_in_one(found: Diagnosis) -> None:
    use = EffectUse("actuator_lag", {"time_constant_s": 0.006})
    late = "sensor_lag(motor_speed_rad_s) + sensor_lag(wheel_speed_rad_s)"
    named = dataclasses.replace(found.effects[0], use=use, confidence=0.9, alike=(late,))
    page: Any = html.fromstring(diagnosis_html(dataclasses.replace(found, effects=(named,)), "axle.toml"))
    words = " ".join(page.text_content().split())
    assert "Named: actuator lag or the same sensor lag of motor speed and wheel speed" in words
