"""Data that cannot give a frequency response, and the name of the reason."""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

from hil.core.errors import BadInputError

Array = npt.NDArray[np.float64]
Reason = Literal[
    "no_excitation", "clipped_input", "low_coherence", "too_short", "uneven_time", "channel_never_moves"
]

LEAST_PERIODS = 2.0
LEAST_SAMPLES_PER_PERIOD = 4.0
_CLIPPED_SHARE = 0.01
_CLIPPED_RATIO = 5.0
_EXCITED_LEVEL = 0.1
_EDGE_GAP_OCTAVES = 0.25
_INNER_GAP_OCTAVES = 1.6  # the first odd harmonics, f and 3 f, lie 1.58 octaves apart


class UnfitDataError(BadInputError):
    """Measured data that an analysis must not use; `reason` names why."""

    def __init__(self, reason: Reason, what: str, *, where: str = "", fix: str = "") -> None:
        self.reason: Reason = reason
        super().__init__(f"{reason.replace('_', ' ')}: {what}", where=where, fix=fix)


def check_signals(input_: Array, outputs: Array, output_names: tuple[str, ...], where: str) -> None:
    """Refuse an input that rests or is clipped, and an output that never moves.

    Args:
        input_: N samples.
        outputs: O x N samples.
        output_names: for the message.
        where: file and segment, for the message.

    Raises:
        UnfitDataError: no_excitation, clipped_input or channel_never_moves.
    """
    if not _moves(input_):
        raise UnfitDataError(
            "no_excitation",
            f"the input stays at {input_[0]:g}",
            where=where,
            fix="run a chirp or a multisine",
        )
    for values, name in zip(outputs, output_names, strict=True):
        if not _moves(values):
            raise UnfitDataError(
                "channel_never_moves",
                f"'{name}' stays at {values[0]:g}",
                where=where,
                fix="check its sensor and its place in the DBC, or leave the channel out",
            )
    for sign, side in ((1.0, "upper"), (-1.0, "lower")):
        share = clipped_share(sign * input_)
        if share > _CLIPPED_SHARE:
            raise UnfitDataError(
                "clipped_input",
                f"{share:.1%} of the samples lie on the input's {side} limit "
                f"{np.max(sign * input_) * sign:.4g}",
                where=where,
                fix="lower the amplitude so that the torque limit is not reached",
            )


def clipped_share(values: Array) -> float:
    """Share of samples on a flat top; 0 for signals that consist of levels (steps, PRBS).

    A sine has at most 2.4 times as many samples in its topmost slice as in the slice below, however
    coarse its quantisation; a clipped one has many times more.
    """
    if np.mean(np.diff(values) != 0) < 0.3:
        return 0.0
    top, span = float(np.max(values)), float(np.ptp(values))
    levels = np.unique(values)
    quantum = float(np.median(np.diff(levels))) if len(levels) < len(values) / 10 else 0.0
    slice_ = max(1e-3 * span, 1.01 * quantum)
    on_top = int(np.sum(values > top - slice_))
    below = int(np.sum((values <= top - slice_) & (values > top - 2 * slice_)))
    if on_top <= _CLIPPED_RATIO * max(below, 1):
        return 0.0
    return on_top / len(values)


def check_length(duration_s: float, sample_time_s: float, from_hz: float, to_hz: float, where: str) -> None:
    """Refuse a stretch with fewer than two periods of the lowest, four samples a period of the highest.

    Raises:
        UnfitDataError: too_short.
    """
    if duration_s * from_hz < LEAST_PERIODS:
        raise UnfitDataError(
            "too_short",
            f"{duration_s:.3g} s hold {duration_s * from_hz:.2g} periods of {from_hz:g} Hz, "
            f"{LEAST_PERIODS:g} are needed",
            where=where,
            fix=f"record longer, or give --from-hz {LEAST_PERIODS / duration_s:.2g} or more",
        )
    if sample_time_s * to_hz * LEAST_SAMPLES_PER_PERIOD > 1:
        raise UnfitDataError(
            "too_short",
            f"a sample time of {sample_time_s * 1e3:.3g} ms is too long for {to_hz:g} Hz",
            where=where,
            fix=f"sample faster, or lower --to-hz to {1 / (LEAST_SAMPLES_PER_PERIOD * sample_time_s):.3g}",
        )


def excited_bands(frequency_hz: Array, density: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Which 1/12-octave bands the input excites.

    A band counts when its amplitude density U, or U times frequency, is at least a tenth of the largest:
    so spectra that fall as slowly as a chirp's or as fast as a step's pass, and what leaks past the end
    of a chirp does not.

    Args:
        frequency_hz: N frequencies above zero, increasing.
        density: N amplitude densities of the input.

    Returns:
        Edges of the B bands (B + 1), and B flags.
    """
    count = max(1, int(np.ceil(12 * np.log2(frequency_hz[-1] / frequency_hz[0]))))
    edges = np.geomspace(frequency_hz[0], frequency_hz[-1], count + 1)
    band = np.clip(np.searchsorted(edges, frequency_hz, side="right") - 1, 0, count - 1)
    lines = np.bincount(band, minlength=count)
    power = np.bincount(band, weights=density**2, minlength=count) / np.maximum(lines, 1)
    filled = lines > 0
    level = np.interp(np.arange(count), np.flatnonzero(filled), np.sqrt(power[filled]))
    weighted = level * np.sqrt(edges[1:] * edges[:-1])
    return edges, (level > _EXCITED_LEVEL * np.max(level)) | (weighted > _EXCITED_LEVEL * np.max(weighted))


def check_excitation(frequency_hz: Array, density: Array, from_hz: float, to_hz: float, where: str) -> None:
    """Refuse a band of which the input leaves out an end or more than 1.6 octaves.

    Raises:
        UnfitDataError: no_excitation, with the frequencies that are missing.
    """
    edges, excited = excited_bands(frequency_hz, density)
    inside = (edges[1:] > from_hz) & (edges[:-1] < to_hz)
    marks = np.log2(np.concatenate([[from_hz], np.sqrt(edges[1:] * edges[:-1])[excited & inside], [to_hz]]))
    gaps = np.diff(marks)
    allowed = np.full(len(gaps), _INNER_GAP_OCTAVES)
    allowed[[0, -1]] = _EDGE_GAP_OCTAVES
    wide = np.flatnonzero(gaps > allowed)
    if not wide.size:
        return
    missing = ", ".join(f"{2 ** marks[i]:.3g}-{2 ** marks[i + 1]:.3g} Hz" for i in wide)
    raise UnfitDataError(
        "no_excitation",
        f"the input leaves {missing} out of {from_hz:g}-{to_hz:g} Hz",
        where=where,
        fix="excite the whole band, or narrow it with --from-hz and --to-hz",
    )


def check_coherence(
    frequency_hz: Array,
    coherence: Array,
    output_names: tuple[str, ...],
    *,
    least: float,
    allowed_share: float,
    where: str,
) -> tuple[str, ...]:
    """Notes on where the coherence is low; refuse when it is low over too much of the band.

    Args:
        frequency_hz: F frequencies.
        coherence: O x F.
        output_names: O names, for the message.
        least: coherence that counts as good enough.
        allowed_share: share of frequencies that may lie below it.
        where: for the message.

    Raises:
        UnfitDataError: low_coherence, with output and frequencies.
    """
    notes = []
    edges = np.concatenate(
        [frequency_hz[:1], np.sqrt(frequency_hz[1:] * frequency_hz[:-1]), frequency_hz[-1:]]
    )
    for values, name in zip(coherence, output_names, strict=True):
        low = ~(values >= least)
        if not low.any():
            continue
        text = f"coherence of '{name}' is below {least:g} at {ranges_text(edges, low)}"
        if np.mean(low) > allowed_share:
            raise UnfitDataError(
                "low_coherence",
                f"{text} ({np.mean(low):.0%} of the frequencies)",
                where=where,
                fix="excite more strongly or longer, average more repetitions, or omit these frequencies",
            )
        notes.append(text)
    return tuple(notes)


def ranges_text(edges: Array, flags: npt.NDArray[np.bool_]) -> str:
    """'0.05-0.1, 9-12 Hz' for the bands (between `edges`) whose flag is set."""
    padded = np.concatenate([[False], flags, [False]])
    starts = np.flatnonzero(padded[1:] & ~padded[:-1])
    ends = np.flatnonzero(~padded[1:] & padded[:-1])
    parts = [f"{edges[a]:.3g}-{edges[b]:.3g}" for a, b in zip(starts, ends, strict=True)]
    shown = ", ".join(parts[:5]) + (f" and {len(parts) - 5} more ranges" if len(parts) > 5 else "")
    return f"{shown} Hz"


def _moves(values: Array) -> bool:
    return bool(np.ptp(values) > 1e-9 * max(1.0, float(np.max(np.abs(values)))))
