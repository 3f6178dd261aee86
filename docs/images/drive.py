"""Makes the pictures of docs/explanation/driveability.md: `python docs/images/drive.py`.

Everything is predicted, on the fitted model and, where play is shown, with ±0.02 rad of it.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.play_crossing import CROSSING, LEAD, LIBRARY, PLAN
from hil.core.controller import load_controller
from hil.core.model import EffectUse, Model, load_model
from hil.core.recording import Recording
from hil.core.result import Segment
from hil.engine import DEFAULT_BENCH, load_bench
from hil.engine.prediction.prediction import predict
from reports.drive_figures import drive_figure
from reports.figure import Band, Figure, Level, Mark, Trace
from reports.labels import Label, channel_label
from reports.order_figures import order_section
from reports.svg_figure import svg_figure
from test_plans import load_plan, plan_from_text
from test_plans.metrics import (
    Clunk,
    Delay,
    Jerk,
    OvershootShaftTorque,
    PeakShaftTorque,
    ResponseTimeShaftTorque,
    Ripple,
    SettlingToReference,
    VibrationDose,
    transient_end_s,
)
from test_plans.metrics._low_pass import low_passed
from test_plans.metrics._orders import orders_removed

HERE = Path(__file__).parent
MODEL = load_model(HERE.parents[1] / "benches/three_inertia.toml")
PLAY = MODEL.with_effects(*MODEL.effects, EffectUse("backlash", {"half_gap_rad": 0.02}))
TORQUE = "shaft_torque_nm"


def run(plan: str, model: Model) -> tuple[Recording, dict[str, Segment]]:
    """A predicted run and its segments by id."""
    found = predict(load_plan(plan), load_bench(DEFAULT_BENCH), model)
    return found.recording, {one.id: one for one in found.segments}


def around(
    recording: Recording, segment: Segment, from_s: float, to_s: float
) -> tuple[np.ndarray, np.ndarray]:
    """Time from the step, and T_s."""
    first, last = np.searchsorted(recording.time_s, (segment.step_s + from_s, segment.step_s + to_s))
    return recording.time_s[first:last] - segment.step_s, recording[TORQUE][first:last]


def chart(name: str, title: str, traces: tuple[Trace, ...], **more: object) -> None:
    """One picture over the time from the step."""
    values: dict[str, object] = {"y_label": channel_label(TORQUE), "y_unit": "N m"} | more
    figure = Figure(
        id=name,
        title=Label(title),
        x_text="Time from the step",
        x_unit="s",
        traces=traces,
        wide=False,
        **values,
    )  # type: ignore[arg-type]
    (HERE / f"{name}.svg").write_bytes(svg_figure(figure))
    print(f"{name}: {title}")


def response(recording: Recording, segment: Segment) -> None:
    """Delay, response time, peak and overshoot of a downward step."""
    x, y = around(recording, segment, -0.05, 0.4)
    reference = np.where(x < 0, segment.reference_before, segment.reference_after)
    size = segment.reference_after - segment.reference_before
    marks = [
        Mark(Delay(channel=TORQUE).compute(recording, segment), segment.reference_before, "delay", "third")
    ]
    for share in (10.0, 50.0, 90.0):
        late_s = ResponseTimeShaftTorque(share_percent=share).compute(recording, segment)
        marks.append(Mark(late_s, segment.reference_before + share / 100 * size, f"{share:g} %", "gain"))
    peak = PeakShaftTorque(to_s=0.4).compute(recording, segment)
    marks.append(Mark(float(x[int(np.argmin(y))]), peak, "peak", "fourth"))
    beyond = OvershootShaftTorque(to_s=0.4).compute(recording, segment)
    chart(
        "drive-response",
        f"Back-out at 30 km/h: peak {peak:.0f} N m, {beyond:.0f} N m beyond what was asked",
        (
            Trace(Label("Shaft torque", channel_label(TORQUE).symbol), x, y, "phase"),
            Trace(Label("Reference"), x, reference, "reference", "dash"),
        ),
        marks=tuple(marks),
        x_range=(-0.05, 0.4),
    )


def play(recording: Recording, segment: Segment) -> None:
    """Time in play, contact, clunk and energy."""
    figure = drive_figure(recording, segment)
    assert figure is not None
    words = figure.caption.removeprefix("○ ").removesuffix(".")
    chart(
        "drive-play",
        f"Change of mind at 30 km/h through ±0.02 rad of play: {words}",
        figure.traces,
        bands=figure.bands,
        marks=figure.marks,
        x_range=(-0.1, 0.4),
    )


def jerk(recording: Recording, segment: Segment) -> None:
    """The vehicle's acceleration and where it changes most."""
    first, last = np.searchsorted(recording.time_s, (segment.start_s, segment.step_s + 0.8))
    speed, time = recording["vehicle_speed_m_s"][first:last], recording.time_s[first:last] - segment.step_s
    acceleration = low_passed(np.diff(speed) / 0.001, 25.0, 0.001)
    shown = time[1:] >= -0.05
    after_s, value = Jerk().largest(recording, segment)
    dose = VibrationDose().compute(recording, segment)
    chart(
        "drive-jerk",
        f"Acceleration: largest jerk {abs(value):.1f} m/s³, vibration dose {dose:.3f} m/s^1.75",
        (Trace(Label("Vehicle's acceleration, 25 Hz"), time[1:][shown], acceleration[shown], "gain"),),
        y_label=Label("Acceleration"),
        y_unit="m/s²",
        marks=(Mark(after_s, float(np.interp(after_s, time[1:], acceleration)), "steepest", "third"),),
        x_range=(-0.05, 0.8),
    )


def windows(recording: Recording, segment: Segment) -> None:
    """The window of the first transient, and the late resonance with the wheel's order that it leaves out."""
    x, y = around(recording, segment, -0.5, 20.0)
    over_s = transient_end_s(recording, segment) - segment.step_s
    first = PeakShaftTorque(until="transient").compute(recording, segment)
    whole = PeakShaftTorque().compute(recording, segment)
    chart(
        "drive-window",
        f"Peak of the first transient {first:.0f} N m, of the whole window {whole:.0f} N m",
        (Trace(Label("Shaft torque", channel_label(TORQUE).symbol), x, y, "phase"),),
        bands=(Band(0.0, over_s, ""),),
        marks=(
            Mark(float(x[int(np.argmax(np.where(x < over_s, y, -np.inf)))]), first, "first", "gain"),
            Mark(float(x[int(np.argmax(y))]), whole, "whole", "fourth"),
        ),
        x_range=(-0.5, 20.0),
    )


def settling(recording: Recording, segment: Segment) -> None:
    """The band around the reference, and the ripple beside it."""
    x, y = around(recording, segment, -0.05, 4.0)
    spacing_s, left = orders_removed(recording, segment, TORQUE, segment.step_s, segment.step_s + 4.0)
    settled = SettlingToReference(channel=TORQUE, mean_s=1.0).compute(recording, segment)
    ripple = Ripple(channel=TORQUE, mean_s=1.0).compute(recording, segment)
    half = 0.05 * abs(segment.reference_after - segment.reference_before)
    chart(
        "drive-settling",
        f"Regeneration to drive at 50 km/h: settled after {settled:.2f} s, ripple ±{ripple:.0f} N m",
        (
            Trace(Label("Shaft torque", channel_label(TORQUE).symbol), x, y, "reference"),
            Trace(Label("without the wheel's third order"), spacing_s * np.arange(len(left)), left, "phase"),
        ),
        levels=tuple(
            Level(segment.reference_after + sign * half, f"{sign * 5:+g} % of the step") for sign in (1, -1)
        ),
        marks=(
            Mark(
                settled, float(np.interp(settled, spacing_s * np.arange(len(left)), left)), "settled", "gain"
            ),
        ),
        x_range=(-0.05, 4.0),
    )


def crossing() -> None:
    """A reversal through play with the shipped lead, and with a torque that crosses it."""
    plan = plan_from_text(PLAN, "reversal.yaml", LIBRARY)
    traces, clunks = [], []
    for role, words, controllers in (
        ("gain", "lead", None),
        ("phase", "crossing of the play", {LEAD: load_controller(CROSSING)}),
    ):
        found = predict(plan, load_bench(DEFAULT_BENCH), PLAY, controllers=controllers)
        x, y = around(found.recording, found.segments[0], -0.05, 0.3)
        traces.append(Trace(Label(f"Shaft torque, {words}"), x, y, role))
        clunks.append(Clunk().compute(found.recording, found.segments[0]))
    chart(
        "drive-crossing",
        f"Regeneration to drive at 30 km/h: clunk {clunks[0]:,.0f} and {clunks[1]:,.0f} N m/s",
        tuple(traces),
        x_range=(-0.05, 0.3),
    )


def waterfall(recording: Recording, segment: Segment) -> None:
    """Spectra of T_s over the wheel's speed, and the amplitude of its third order."""
    section = order_section(recording, [segment])
    assert section is not None
    for name, figure in zip(("drive-waterfall", "drive-orders"), section.figures, strict=True):
        (HERE / f"{name}.svg").write_bytes(svg_figure(replace(figure, wide=False)))
        print(f"{name}: {figure.title.plain()}; {figure.caption}")


def main() -> None:
    """All pictures, beside this file."""
    plain, plain_segments = run("driveability", MODEL)
    loose, loose_segments = run("driveability", PLAY)
    accepted, accepted_segments = run("acceptance", MODEL)
    crossing()
    response(plain, plain_segments["back_out_30"])
    play(loose, loose_segments["change_of_mind_30"])
    jerk(loose, loose_segments["change_of_mind_30"])
    windows(accepted, accepted_segments["phase_0kmh"])
    waterfall(accepted, accepted_segments["phase_20kmh"])
    settling(plain, plain_segments["regen_to_drive_50"])


if __name__ == "__main__":
    main()
