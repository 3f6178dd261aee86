from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hil.core.recording import Recording
from hil.core.result import RunResult, Segment
from reports import labels
from reports.sections import sections


def test_each_initial_speed_overlays_both_controllers(recording: Recording, result: RunResult) -> None:
    slow, fast, overview = sections(recording, result)
    assert (slow.title, fast.title) == ("Steps from 0\u202fkm/h", "Steps from 20\u202fkm/h")
    assert overview.title == "The whole run"
    for section in (slow, fast):
        assert len(section.figures) == 6
        for figure in section.figures:
            assert [trace.role for trace in figure.traces][:2] == ["gain", "phase"]
    assert [band.label for band in overview.figures[0].bands] == [s.id for s in result.segments]


def test_time_counts_from_the_step(recording: Recording, result: RunResult) -> None:
    figures = {figure.id: figure for figure in sections(recording, result)[1].figures}
    trace = figures["steps-20kmh-shaft-torque"].traces[0]
    assert (trace.x[0], trace.x[-1]) == (-1.0, 20.0)
    segment = result.segments[2]
    assert trace.y.max() == recording.between(segment.start_s, segment.end_s)["shaft_torque_nm"].max()


def test_the_spectrum_shows_the_ripple_in_the_marked_band(recording: Recording, result: RunResult) -> None:
    figures = {figure.id: figure for figure in sections(recording, result)[1].figures}
    spectrum = figures["steps-20kmh-motor-speed-spectrum"]
    assert [(band.start, band.end) for band in spectrum.bands] == [(8.0, 20.0)]
    gain, phase = spectrum.traces
    assert 8.0 < gain.x[gain.y.argmax()] < 20.0
    assert gain.y.max() > phase.y.max()
    assert "amplitude" in spectrum.caption.lower()


def test_names_in_figures_carry_the_criterions_value(recording: Recording, result: RunResult) -> None:
    figures = {figure.id: figure for figure in sections(recording, result)[0].figures}
    peak = next(c for c in result.criteria if c.id == "gain_0kmh.peak_shaft_torque").value
    label = figures["steps-0kmh-shaft-torque"].traces[0].label.text
    assert label == f"Gain stabilization, peak {peak:.0f}\u202fN\u202fm"
    (limit,) = figures["steps-0kmh-shaft-torque-enlarged"].levels
    assert limit.value == 534.0


def test_repeats_of_a_controller_share_its_colour(recording: Recording, result: RunResult) -> None:
    first = result.segments[0]
    again = result.segments[1].model_copy(update={"controller": "gain", "id": "gain_again"})
    section = sections(recording, result.model_copy(update={"segments": (first, again)}))[0]
    one, two = section.figures[0].traces
    assert (one.role, two.role) == ("gain", "gain")
    assert one.dash != two.dash
    assert "gain_again" in two.label.text


def test_a_missing_channel_is_named_and_costs_only_its_figures(
    recording: Recording, result: RunResult
) -> None:
    del recording.channels["shaft_torque_nm"]
    recording.channels["driving_torque_est_nm"][:] = np.nan
    section = sections(recording, result)[0]
    assert len(section.figures) == 3
    assert section.figures[-1].wide
    (note,) = section.notes
    assert "T_s" in note
    assert "rF̂_d" in note


def test_a_step_too_short_for_a_spectrum_lacks_the_spectrum_alone(
    recording: Recording, result: RunResult
) -> None:
    short = result.segments[0].model_copy(update={"end_s": result.segments[0].step_s + 3.0})
    section = sections(recording, result.model_copy(update={"segments": (short,)}))[0]
    assert section.figures[0].title.text == "Motor speed"
    assert section.notes == ("Not drawn for want of values: Spectrum of motor speed ω_m.",)


def test_a_sweep_shows_input_outputs_and_their_spectra(recording: Recording, result: RunResult) -> None:
    sweep = Segment(id="chirp", kind="chirp", start_s=2.0, step_s=2.0, end_s=22.0)
    section = sections(recording, result.model_copy(update={"segments": (sweep,)}))[0]
    assert section.title == "Segment chirp"
    assert sum(figure.logarithmic for figure in section.figures) == 4
    assert len(section.figures) == 8


def test_impossible_segments_give_notes_and_unique_ids(recording: Recording, result: RunResult) -> None:
    segments = (
        Segment(id='a "b"', kind="hold", start_s=5, step_s=4, end_s=3),
        Segment(id="a (b", kind="hold", start_s=500, step_s=504, end_s=603),
        Segment(id="n", start_s=float("nan"), step_s=4, end_s=3),
    )
    found = sections(recording, result.model_copy(update={"segments": segments}))
    ids = [section.id for section in found]
    assert len(set(ids)) == len(ids)
    assert all(" " not in name and '"' not in name for name in ids)
    assert [len(section.figures) for section in found] == [0, 0, 0, 3]
    assert all(section.notes for section in found[:3])


def test_without_segments_every_channel_is_drawn(recording: Recording) -> None:
    recording.channels["oil_temperature"] = 60 + recording.time_s / 10
    (section,) = sections(recording, None)
    titles = [figure.title.plain() for figure in section.figures]
    assert "oil_temperature" in titles
    assert "Spectrum: shaft torque T_s" in titles


def test_many_unknown_channels_are_left_to_the_table(recording: Recording) -> None:
    recording.channels.update({f"extra_{number}": recording.time_s for number in range(20)})
    (section,) = sections(recording, None)
    assert section.notes == ("8 further channels are in the table only.",)


def test_an_empty_recording_has_no_figures(result: RunResult) -> None:
    empty = Recording({}, Path("empty.csv"))
    assert all(not section.figures for section in (*sections(empty, None), *sections(empty, result)))


def test_peaks_that_criteria_judge_are_marked_where_they_are(recording: Recording, result: RunResult) -> None:
    (section,) = [s for s in sections(recording, result) if s.id == "steps-0kmh"]
    (figure,) = [f for f in section.figures if f.id == "steps-0kmh-shaft-torque"]
    assert len(figure.marks) == len(figure.traces) == 2
    for mark, trace in zip(figure.marks, figure.traces, strict=True):
        after = trace.x >= 0
        highest = int(np.nanargmax(trace.y[after]))
        assert (mark.x, mark.y) == (pytest.approx(trace.x[after][highest]), trace.y[after][highest])
        assert f"at {labels.quantity(mark.x, 's', 3)}" in figure.caption


def test_what_further_devices_measured_is_drawn_on_the_same_time(
    recording: Recording, result: RunResult
) -> None:
    further = {
        "slip_ref": np.sin(recording.time_s),
        "oil_temperature_k": np.full(len(recording.time_s), 330.0),
    }
    more = Recording(
        {**recording.channels, **further, "dyno_torque_left_nm": recording.time_s},
        recording.source,
        metadata={"units": {"oil_temperature_k": "K"}},
    )
    overview, section = sections(more, result)[-2:]
    assert [figure.id for figure in section.figures] == ["further-slip_ref", "further-oil_temperature_k"]
    assert section.figures[0].bands == overview.figures[0].bands
    assert [figure.y_unit for figure in section.figures] == ["", "K"]
    many = {f"channel_{n}": recording.time_s for n in range(20)}
    section = sections(Recording({**recording.channels, **many}, recording.source), result)[-1]
    assert len(section.figures) == 12
    assert section.notes == ("8 further channels are in the recording only.",)
