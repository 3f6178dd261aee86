"""How far simulation and measurement are apart: per channel, band, recording and operating condition.

Of recordings that no fit has seen also whether that is more than it may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from hil.analysis.diagnosis.thresholds import (
    FAR_NOISES,
    LARGE,
    MOMENT_S,
    STANDSTILL_SHARE,
    VISIBLE,
)
from hil.analysis.missing_effects import SLOW_NOISE, Series, Verdict
from hil.core.channels import OUTPUTS
from hil.core.errors.wording import factor, multiple

Array = npt.NDArray[np.float64]

BANDS_HZ = ((0.0, 1.0), (1.0, 3.0), (3.0, 6.0), (6.0, 10.0), (10.0, 15.0), (15.0, 30.0), (30.0, 125.0))
CONDITIONS = ("near standstill", "torque reversals", "large torque", "high speed", "elsewhere")

_WHAT_TO_DO = (
    "something is missing, or a number is wrong, that the recordings fitted do not show; give those held out "
    "as recordings too, and hold others out"
)
_FITTED_TOO = "something more is missing, which the recordings fitted show as well"
_OR_ANGLES = (
    "a ripple's angle, integrated from a speed, walks off with that speed's noise (record the angle), or "
)


@dataclass(frozen=True)
class ChannelGap:
    """Ratios to the rms of the measured channel around its mean."""

    gap: float
    noise_floor: float

    @property
    def noises(self) -> float:
        """The gap over the noise floor."""
        return self.gap / max(self.noise_floor, 1e-12)


@dataclass(frozen=True)
class GapMap:
    """Error over noise (1: nothing but noise): recordings x channels x bands, and conditions x channels.

    NaN where a channel was not measured.
    """

    recordings: tuple[str, ...]
    by_band: Array
    by_condition: Array


def channel_gaps(traces: Sequence[Series], floor: Array, simulated: Sequence[Array]) -> dict[str, ChannelGap]:
    """Gap and noise floor of each measured channel over the recordings together.

    Args:
        floor: standard deviation of each channel's noise per sample, shape (3,).
        simulated: channels of each recording at full rate, n x 3.
    """
    gaps = {}
    for column, channel in enumerate(OUTPUTS):
        pairs = [
            (t.samples[:, column], s[:, column])
            for t, s in zip(traces, simulated, strict=True)
            if t.has[column]
        ]
        if not pairs:
            continue
        gaps[channel] = channel_gap([m for m, _ in pairs], [s for _, s in pairs], float(floor[column]))
    return gaps


def channel_gap(measured: Sequence[Array], simulated: Sequence[Array], floor: float) -> ChannelGap:
    """Gap and noise floor of a channel over recordings, (n,) each, together."""
    whole = np.concatenate(measured)
    error = whole - np.concatenate(simulated)
    spread = max(float(np.std(whole)), 1e-12)
    return ChannelGap(float(np.sqrt(np.mean(error**2))) / spread, floor / spread)


def gap_map(traces: Sequence[Series], noise: Array, simulated: Sequence[Array]) -> GapMap:
    """Where the error stands above `noise`, the standard deviation of each channel per sample, shape (3,)."""
    bands = np.full((len(traces), 3, len(BANDS_HZ)), np.nan)
    sums, counts = np.zeros((2, len(CONDITIONS), 3))
    for row, (trace, values) in enumerate(zip(traces, simulated, strict=True)):
        error = (trace.samples - values) / noise
        masks = conditions_of(trace.samples, trace.torque, trace.dt)
        for column in np.flatnonzero(trace.has):
            bands[row, column] = _band_ratios(error[:, column], trace.dt)
            sums[:, column] += masks @ error[:, column] ** 2
            counts[:, column] += masks.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        condition = np.sqrt(sums / counts)
    return GapMap(tuple(t.name for t in traces), bands, condition)


def made_worse(before: GapMap, after: GapMap) -> list[str]:
    """In words where the error grew: channel, band and recording, worst first."""
    grown = np.nan_to_num(after.by_band) > np.maximum(FAR_NOISES, VISIBLE * np.nan_to_num(before.by_band))
    places = sorted(np.argwhere(grown).tolist(), key=lambda place: -after.by_band[tuple(place)])
    words = []
    for row, column, band in places:
        low, high = BANDS_HZ[band]
        old, new = before.by_band[row, column, band], after.by_band[row, column, band]
        words.append(
            f"{OUTPUTS[column]} at {low:g}-{high:g} Hz in {before.recordings[row]}: "
            f"from {factor(old)} to {multiple(new)} the noise"
        )
    return words


def _band_ratios(error: Array, dt: float) -> Array:
    power = np.abs(np.fft.rfft(error)) ** 2 / len(error)
    frequency = np.fft.rfftfreq(len(error), dt)
    ratios = np.full(len(BANDS_HZ), np.nan)
    for index, (low, high) in enumerate(BANDS_HZ):
        inside = (frequency >= low) & (frequency < high)
        if inside.any():
            ratios[index] = np.sqrt(np.mean(power[inside]))
    return ratios


def conditions_of(samples: Array, torque: Array, dt: float) -> Array:
    """Which samples belong to each of `CONDITIONS`, as 0/1, conditions x samples; each to one alone."""
    speed = np.abs(np.where(np.isfinite(samples[:, 0]), samples[:, 0], samples[:, 1]))
    fastest = max(float(np.max(np.nan_to_num(speed), initial=0.0)), 1e-9)
    largest = max(float(np.max(np.abs(torque))), 1e-9)
    flips = np.flatnonzero(np.diff(np.sign(torque)) != 0)
    near_flip = np.zeros(len(torque))
    near_flip[flips] = 1.0
    reach = max(1, round(MOMENT_S / dt))
    after = np.convolve(near_flip, np.ones(reach))[: len(torque)] > 0
    masks = [
        speed < STANDSTILL_SHARE * fastest,
        after,
        np.abs(torque) > LARGE * largest,
        speed > LARGE * fastest,
    ]
    left = np.ones(len(torque), bool)
    rows = []
    for mask in masks:
        rows.append(mask & left)
        left &= ~mask
    return np.array([*rows, left], dtype=float)


@dataclass(frozen=True)
class Event:
    """The moment at which a held-out recording is furthest off: rms over `MOMENT_S` in noise levels."""

    channel: str
    recording: str
    time_s: float
    noises: float


@dataclass(frozen=True)
class HeldOut:
    """Gaps with the model as it came and with the one given back, empty without recordings held out.

    `walks`: the model follows an angle that was not recorded. `fitted_too`: recordings that were fitted keep
    more than noise as well.
    """

    before: dict[str, ChannelGap]
    after: dict[str, ChannelGap]
    event: Event | None
    walks: bool = False
    fitted_too: bool = False

    def open(self, verdict: Verdict) -> tuple[str, ...]:
        """Channels that keep more than noise, or where nothing is named, more than is proven to be noise."""
        most = SLOW_NOISE if verdict == "none" else VISIBLE
        return tuple(channel for channel, gap in self.after.items() if gap.noises > most)

    def words(self, verdict: Verdict) -> str:
        """What to say where they disagree, nothing where they do not, or nothing explains the fitted either.

        A moment that is far off beside hours that are not counts where nothing is named as missing; beside
        a name, whose law may differ a little, only what counts in the whole.
        """
        if verdict == "unknown":
            return ""
        lines = []
        if channels := self.open(verdict):
            kept = ", ".join(f"{multiple(self.after[c].noises)} its noise in {c}" for c in channels)
            lines.append(f"held-out recordings leave {kept}")
        if verdict == "none" and self.event is not None and self.event.noises > FAR_NOISES:
            e = self.event
            lines.append(
                f"held-out recording {e.recording} is off by {multiple(e.noises)} the noise in {e.channel} "
                f"at {e.time_s:.4g} s"
            )
        why = _FITTED_TOO if self.fitted_too else _WHAT_TO_DO
        return f"{'; '.join(lines)}: {_OR_ANGLES if self.walks else ''}{why}" if lines else ""


def furthest(traces: Sequence[Series], noise: Array, simulated: Sequence[Array]) -> Event | None:
    """Where simulated channels (n x 3 each recording) are furthest off for a moment, in `noise` (3,)."""
    found = None
    for trace, values in zip(traces, simulated, strict=True):
        length = max(1, round(MOMENT_S / trace.dt))
        error = (trace.samples - values) / noise
        count = len(error) // length
        power = np.mean(error[: count * length].reshape(count, length, 3) ** 2, axis=1)
        for column in np.flatnonzero(trace.has).tolist():
            at = int(np.argmax(power[:, column]))
            noises = float(np.sqrt(power[at, column]))
            if found is None or noises > found.noises:
                found = Event(OUTPUTS[column], trace.name, (at + 0.5) * length * trace.dt, noises)
    return found
