"""What a run measures, while it measures: read from its recording as that grows.

The run knows nothing of viewers and cannot be held up by them: it writes its file as it always does. Viewers
share what is read here; one that is slow gets wider buckets, which still have every peak.
"""

from __future__ import annotations

import contextlib
import datetime
import itertools
from collections import deque
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from hil.core.channels import COMFORT_BAND_HZ, TIME
from hil.core.errors import BadInputError
from hil.core.recording import SEGMENT, EnvelopeBuilder, FollowedRecording, Overview, read_recording
from hil.core.result import CriterionResult, Segment
from test_plans import Plan, judge
from test_plans.metrics import energy_within, periodogram

BUCKET_S = 0.02
_KEPT_S = 60.0
_BEHIND_S = 0.2  # a run writes what it measured every 0.15 s
#: Buckets that are sent at once; what is more is joined.
MOST_BUCKETS = 300
SPECTRUM_CHANNEL = "motor_speed_rad_s"
_SPECTRUM_S = 8.0
_HIGHEST_HZ = 40.0

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Stretch:
    """Lowest and highest values of channels in buckets of equal width.

    `first` counts buckets of `BUCKET_S` from the recording's zero; `lowest` and `highest` have shape
    (buckets, channels), NaN where nothing was measured.
    """

    first: int
    width_s: float
    names: tuple[str, ...]
    lowest: Array
    highest: Array

    @property
    def start_s(self) -> float:
        """Time of the recording at which the first bucket begins."""
        return self.first * BUCKET_S


class Buckets:
    """The last minute of a run, as the lowest and the highest value of each channel in every bucket.

    What was written at once is shown bucket by bucket, as fast as it was measured: `show` lets time pass.
    """

    def __init__(self) -> None:
        self.names: tuple[str, ...] = ()
        self.next = 0  # number of the bucket that is being filled
        self._shown = 0.0
        self._done: deque[tuple[Array, Array]] = deque(maxlen=round(_KEPT_S / BUCKET_S))
        self._open: tuple[Array, Array] | None = None

    def add(self, names: list[str], rows: Array) -> None:
        """Take rows of samples, shape (samples, channels), the first channel being the time."""
        if not len(rows):
            return
        self.names = tuple(names[1:])
        numbers = np.floor(rows[:, 0] / BUCKET_S + 1e-6).astype(np.int64)
        starts = np.flatnonzero(np.diff(numbers, prepend=-1))
        with np.errstate(all="ignore"):
            lowest = np.fmin.reduceat(rows[:, 1:], starts)
            highest = np.fmax.reduceat(rows[:, 1:], starts)
        for number, low, high in zip(numbers[starts].tolist(), lowest, highest, strict=True):
            self._add(number, low, high)

    @property
    def shown(self) -> int:
        """Number of the first that is not shown yet."""
        return int(self._shown)

    @property
    def oldest(self) -> int:
        """Number of the first that is still kept."""
        return self.next - len(self._done)

    def bucket(self, number: int) -> tuple[Array, Array]:
        """Lowest and highest values of one that is kept, in the order of `names`."""
        return self._done[number - self.oldest]

    def show(self, passed_s: float) -> bool:
        """Show what was measured in so much time, and whatever is late; says whether there was anything."""
        before, late = self.shown, self.next - round(_BEHIND_S / BUCKET_S)
        self._shown = min(max(self._shown + passed_s / BUCKET_S, late), self.next)
        return self.shown > before

    def since(self, number: int) -> Stretch | None:
        """Buckets shown from a number on, joined to `MOST_BUCKETS` at most; None if there is none."""
        kept = self.oldest
        first = max(number, kept)
        count = self.shown - first
        if count <= 0:
            return None
        done = list(itertools.islice(self._done, first - kept, self.shown - kept))
        low, high = np.array([one[0] for one in done]), np.array([one[1] for one in done])
        joined = -(-count // MOST_BUCKETS)
        starts = np.arange(0, count, joined)
        return Stretch(
            first,
            joined * BUCKET_S,
            self.names,
            np.fmin.reduceat(low, starts),
            np.fmax.reduceat(high, starts),
        )

    def _add(self, number: int, low: Array, high: Array) -> None:
        if self._open is None:
            self.next = number
            self._shown = float(number)
        while self._open is not None and number > self.next:
            self._done.append(self._open)
            self.next += 1
            nothing = np.full(len(low), np.nan)
            self._open = (nothing, nothing)
        if self._open is None:
            self._open = (low, high)
        else:
            self._open = (np.fmin(self._open[0], low), np.fmax(self._open[1], high))


@dataclass(frozen=True)
class Spectrum:
    """Power spectral density of ω_m over the last seconds, (rad/s)²/Hz, and what of it lies in the band."""

    step_hz: float
    density: Array
    band_energy: float


class LiveRun:
    """A run's recording as it grows."""

    def __init__(self, path: Path, plan: Plan) -> None:
        self._path, self._plan = path, plan
        self._file: FollowedRecording | None = None
        self._recent = np.zeros((2, 0))  # times and values of the spectrum's channel
        self._judged: frozenset[str] = frozenset()
        self._envelope: EnvelopeBuilder | None = None
        self.buckets = Buckets()
        self.time_s = 0.0
        self.last_speed: tuple[float, datetime.datetime] | None = None  # of the motor, rad/s; when it came

    def look(self, passed_s: float) -> bool:
        """Read what has come, `passed_s` after the last look; whether there is more to show."""
        self._read()
        return self.buckets.show(passed_s)

    def _read(self) -> None:
        if self._file is None:
            with contextlib.suppress(BadInputError):
                self._file = FollowedRecording(self._path)
        if self._file is None:
            return
        try:
            parts = self._file.fetch_parts()
        except (BadInputError, OSError, ValueError):  # a damaged file is the run's to report
            self.close()
            return
        if parts:
            self._envelope = self._envelope or EnvelopeBuilder(self._file.names[1:])
            for position, part in parts:
                self._envelope.add(position, part)
            rows = np.concatenate([part for _, part in parts])
            self.time_s = float(rows[-1, 0])
            self.buckets.add(self._file.names, rows)
            self._remember(rows)

    @property
    def path(self) -> Path:
        """Where the recording lies."""
        return self._path

    @property
    def over(self) -> bool:
        """Whether all of the recording has been read, to its regular end."""
        return self._file is not None and self._file.over

    def overview(self) -> Overview | None:
        """All that was measured until now; None before the first sample."""
        envelope = self._envelope.envelope() if self._envelope else None
        if envelope is None or self._file is None:
            return None
        return Overview(envelope, dict(self._file.tables), tuple(self._file.events), self._file.row_ids)

    @property
    def marks(self) -> tuple[int, int]:
        """Changes whenever there is a new segment or event."""
        return (len(self._file.tables), len(self._file.events)) if self._file is not None else (0, 0)

    def spectrum(self) -> Spectrum | None:
        """Of the last seconds; None while there are none."""
        time, values = self._recent
        spacing_s = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
        if spacing_s <= 0.0 or len(time) * spacing_s < 0.9 * _SPECTRUM_S or not np.isfinite(values).all():
            return None
        hz, density = periodogram(values, spacing_s)
        energy = energy_within(hz, density, *COMFORT_BAND_HZ)
        return Spectrum(float(hz[1]), density[hz <= _HIGHEST_HZ], energy)

    def decided(self) -> tuple[CriterionResult, ...] | None:
        """Criteria whose segments have ended, when one has ended since the last call.

        Reads the recording; may take some tenths of a second, and may be called from another thread.
        """
        segments = self._ended_segments()
        names = frozenset(segment.id for segment in segments)
        if names == self._judged:
            return None
        self._judged = names
        try:
            recording = read_recording(self._path, least_samples=0, allow_missing=True)
            criteria = judge(self._plan, recording, segments)
        except (BadInputError, ValueError, OSError):
            return None
        return tuple(one for one in criteria if one.verdict != "not_judged")

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            self._file.close()
        self._file = None

    def _ended_segments(self) -> list[Segment]:
        tables = self._file.tables if self._file is not None else {}
        found = []
        for name, table in tables.items():
            if name.startswith(SEGMENT):
                segment = Segment.model_validate_json(table["json"])
                if segment.complete and segment.end_s > segment.step_s and segment.end_s <= self.time_s:
                    found.append(segment)
        return found

    def _remember(self, rows: Array) -> None:
        """Keep the last seconds of the spectrum's channel."""
        assert self._file is not None
        if SPECTRUM_CHANNEL not in self._file.names:
            return
        column = self._file.names.index(SPECTRUM_CHANNEL)
        new = rows[:, [self._file.names.index(TIME), column]].T
        both = np.concatenate([self._recent, new], axis=1)
        self._recent = both[:, both[0] > both[0, -1] - _SPECTRUM_S]
        known = new[1, np.isfinite(new[1])]
        if len(known):
            self.last_speed = float(known[-1]), datetime.datetime.now(datetime.UTC)
