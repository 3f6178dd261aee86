"""What the report of a diagnosis says: sections with tables, maps (shaded tables) and figures."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis import (
    BANDS_HZ,
    CONDITIONS,
    ChannelGap,
    Diagnosis,
    GapMap,
    why_no_step,
)
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import multiple, share
from hil.core.model import parameter_unit
from reports import labels
from reports.diagnosis_figures import (
    WINDOW_S,
    GapBars,
    GapRow,
    curve_figures,
    overlay_figure,
    overlay_figures,
    shown_overlay,
)
from reports.diagnosis_names import (
    alternatives_table,
    effects_table,
    effects_text,
    names_of,
)
from reports.diagnosis_steps import next_steps
from reports.labels import Label, channel_label, parameter_title, with_titles
from reports.parts import Cell, Map, Part, Table, paired

Array = npt.NDArray[np.float64]

_HEADLINES = {
    "named": "Named: {names}",
    "none": "The model explains the data to the noise",
    "unknown": "A gap that no known effect closes",
}
_HELD_OUT = "Recordings held out disagree with the model"
MOST_WORSE = 3
_HALF_INTERVAL = 1.96  # of 95 %, in standard errors
_DARKEST = 30.0  # error over noise
_FIGURES = {
    "overshoot_shaft_torque_percent": "overshoot of the shaft torque, %",
    "band_energy_motor_speed": "8-20 Hz energy of the motor speed's ringing, (rad/s)²",
}


def headline(found: Diagnosis) -> str:
    """The verdict in one line."""
    if found.unfinished:
        return f"Unfinished: {found.unfinished}"
    if found.verdict == "unknown" and found.held_out_open and not found.open_channels:
        return _HELD_OUT
    names = ", ".join(names_of(e) for e in found.effects)
    return _HEADLINES[found.verdict].format(names=names)


def lead(found: Diagnosis) -> str:
    """The verdict in numbers."""
    if found.verdict == "unknown":
        return f"What is known of it: {found.signature}."
    if found.verdict == "none":
        left, held = (
            max(_over_noise(one).values(), default=None) for one in (found.gap_after, found.holdout_after)
        )
        also = "" if held is None else f", {multiple(held)} in held-out recordings"
        return f"The gap is at most {multiple(left or 0.0)} the noise{also}."
    before, after, where = _telling(found)
    worst = max(before, key=lambda channel: before[channel].noises)
    had, has, noise = before[worst].gap, after[worst].gap, before[worst].noise_floor
    closed = (had - has) / max(had - noise, 1e-12)
    closes = f"closes {share(min(closed, 1.0))} of the largest gap" if closed > 0.0 else "closes no gap"
    return (
        f"On {where} the model after {closes}: {channel_label(worst).text.lower()} is "
        f"{share(had, 2, digits=3)} of its signal off before, {share(has, 2, digits=3)} after; "
        f"noise is {share(noise, 2, digits=3)}."
    )


def _telling(found: Diagnosis) -> tuple[dict[str, ChannelGap], dict[str, ChannelGap], str]:
    """The gaps that count most, before and after: of recordings not used in the fit where there are any."""
    if found.holdout_after:
        return found.holdout_before, found.holdout_after, "held-out recordings"
    return found.gap_before, found.gap_after, "the recordings that were fitted"


def _bars(found: Diagnosis) -> GapBars:
    """The gaps that count most."""
    before, after, where = _telling(found)
    rows = tuple(
        GapRow(
            channel_label(channel).text,
            100.0 * before[channel].gap,
            100.0 * gap.gap,
            100.0 * gap.noise_floor,
        )
        for channel, gap in after.items()
    )
    return GapBars("gap-bars", Label("Measured minus simulated"), rows, f"On {where}.")


def _over_noise(gaps: Mapping[str, ChannelGap]) -> dict[str, float]:
    return {c: g.noises for c, g in gaps.items()}


def first(found: Diagnosis) -> Part:
    """What is missing and how sure, its curve, how much of the gap it closes on data that were not fitted."""
    held = bool(found.holdout_after)
    tables = (*_if_any(effects_table(found)), _gaps(found)[-1 if held else 0])
    figures = (*curve_figures(found)[:1], overlay_figure(shown_overlay(found)))
    title = "What is missing, and what it closes" if found.effects else "What stays of the gap"
    return Part("glance", title, "", tables, figures=figures)


def parts(found: Diagnosis) -> list[Part]:
    """All sections in order; one without tables, maps, figures and text has nothing to tell."""
    overlay, held = shown_overlay(found), ", held out" if found.holdout_after else ""
    first = Part("start", "Identified first", _start_text(found), _if_any(_start(found)))
    return [
        Part("next", "What to do next", "", _if_any(next_steps(found))),
        *([first] if found.start is not None else []),
        Part("effects", "Effects named", effects_text(found), figures=paired(curve_figures(found)[1:])),
        Part(
            "gap",
            "Gap per channel",
            "Rms of measured minus simulated as a share of the rms of the measured channel around its "
            "mean. The noise floor is the same for the noise that is proven: by the spectrum above all "
            f"modes, by the distance of readings, or as stated.{_what_stays(found)}",
            _gaps(found)[:-1],  # the last stands on the first page
            figures=(_bars(found),),
        ),
        Part(
            "map",
            "Where the gap is",
            f"Error over noise. No shade: noise alone (1). Darkest: {_DARKEST:g} times the noise or more.",
            maps=_maps(found),
        ),
        Part(
            "overlays",
            "Measured and simulated",
            f"What the new model changes most ({overlay.name}{held}): {WINDOW_S:g} s where the old one was "
            "worst, measured minus simulated there, and the spectra of the errors.",
            figures=overlay_figures(overlay),
        ),
        Part("parameters", "Parameters of the model", "", _if_any(_parameters(found))),
        Part(
            "consequences",
            "What it does to a torque step",
            "Open-loop step of 20 N m from 5 rad/s wheel speed, model before and after; ± for what the fit "
            "leaves open of its numbers. Energy: of the ringing in the 5 s after the step. For "
            "the effect in closed loop, see hil compare."
            if found.consequences
            else why_no_step(found.model),
            _if_any(_consequences(found)),
        ),
        Part("alternatives", "Alternative explanations", "", _if_any(alternatives_table(found))),
    ]


def _gaps(found: Diagnosis) -> tuple[Table, ...]:
    """One table for the fitted recordings, one for those held out."""
    tables = []
    for name, before, after, angles in (
        ("fitted recordings", found.gap_before, found.gap_after, found.angles),
        ("held-out recordings", found.holdout_before, found.holdout_after, found.holdout_angles),
    ):
        rows = tuple(
            (
                channel_label(c).text,
                *(labels.share(v, 2, digits=3) for v in _figures(before[c], after[c])),
                labels.factor(before[c].noises),
                labels.factor(after[c].noises),
            )
            for c in after
        ) + tuple(  # it adds up what a speed leaves: times its noise it would say nothing
            (
                channel_label(c).text,
                *(labels.share(v, 2, digits=3) for v in _figures(*both)),
                labels.DASH,
                labels.DASH,
            )
            for c, both in angles.items()
        )
        if rows:
            head = (name, "before", "after", "noise floor", "before / noise", "after / noise")
            tables.append(Table(head, rows))
    return tuple(tables)


def _figures(before: ChannelGap, after: ChannelGap) -> tuple[float, float, float]:
    return before.gap, after.gap, after.noise_floor


def _what_stays(found: Diagnosis) -> str:
    """What a name leaves, and where it makes things worse."""
    words = ""
    if found.open_channels:
        names = ", ".join(channel_label(c).text.lower() for c in found.open_channels)
        words += f" What stays is more than noise: {names}."
    if found.worse:
        words += f" Made worse: {'; '.join(map(with_titles, found.worse[:MOST_WORSE]))}."
    return words


def _maps(found: Diagnosis) -> tuple[Map, ...]:
    """Before and after side by side: by recording and band of each channel, then by condition."""
    head = ("Hz", *(f"{low:g}-{high:g}" for low, high in BANDS_HZ))
    both = (("before", found.map_before), ("after", found.map_after))
    maps = []
    for column, channel in enumerate(OUTPUTS):
        if np.isfinite(found.map_before.by_band[:, column]).any():
            for when, gaps in both:
                cells = tuple(
                    (name, tuple(map(_cell, gaps.by_band[row, column])))
                    for row, name in enumerate(gaps.recordings)
                )
                maps.append(Map(f"{channel_label(channel).text}, {when}", head, cells))
    maps += [_conditions(when, gaps) for when, gaps in both]
    return tuple(maps)


def _conditions(when: str, gaps: GapMap) -> Map:
    rows = tuple(
        (channel_label(channel).text, tuple(map(_cell, gaps.by_condition[:, column])))
        for column, channel in enumerate(OUTPUTS)
        if np.isfinite(gaps.by_condition[:, column]).any()
    )
    return Map(f"Operating conditions, {when}", ("", *CONDITIONS), rows)


def _cell(ratio: float) -> Cell:
    if not np.isfinite(ratio):
        return Cell(labels.DASH, 0.0)
    shade = float(np.clip(np.log(max(ratio, 1.0)) / np.log(_DARKEST), 0.0, 1.0))
    return Cell(labels.factor(ratio), round(shade, 3))


def _start_text(found: Diagnosis) -> str:
    if found.start is None:
        return ""
    gaps = ", ".join(
        f"{channel_label(c).text.lower()} {share(g.gap, 2, digits=3)}" for c, g in found.start.gap.items()
    )
    return (
        "The base model was far from the data as a whole: most of its numbers were wrong. Other numbers "
        f"alone, from {', '.join(found.start.recordings)}, leave a gap of {gaps}."
    )


def _start(found: Diagnosis) -> Table:
    return _changes(found.start.parameters if found.start is not None else {})


def _parameters(found: Diagnosis) -> Table:
    return _changes(found.parameter_updates)


def _changes(changes: Mapping[str, tuple[float, float, float]]) -> Table:
    rows = tuple(
        (
            parameter_title(name),
            labels.number(old),
            labels.number(new),
            labels.number(error, significant=2),
            labels.share(new / old - 1.0, 2, signed=True) if old else labels.DASH,
            parameter_unit(name),
        )
        for name, (old, new, error) in changes.items()
    )
    return Table(("parameter", "from", "to", "standard error", "change", "unit"), rows, 1, 5)


def _consequences(found: Diagnosis) -> Table:
    rows = tuple(
        (
            _FIGURES.get(name, name),
            labels.number(v["before"]),
            labels.number(v["after"]),
            _uncertain(v.get("after_standard_error")),
        )
        for name, v in found.consequences.items()
    )
    return Table(("figure", "before", "after", "± (95 %)"), rows)


def _uncertain(standard_error: float | None) -> str:
    """Half a 95 % interval, to the two digits that it is known to."""
    if standard_error is None:
        return labels.DASH
    return labels.number(_HALF_INTERVAL * standard_error, significant=2)


def _if_any(table: Table) -> tuple[Table, ...]:
    return (table,) if table.rows else ()
