"""Takes every frame and every sample of a run into the recording."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, MutableMapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from drivers import SampleAssembler, Samples, Stream
from hil.core.can.frames import FrameBlock
from hil.core.channels import TIME
from hil.core.errors import BenchError, HilError
from hil.core.files import sha256_of
from hil.core.recording import SOURCE, Event, Recording, RecordingWriter, read_as_written
from hil.core.result import StreamClock
from hil.core.runtime.clock import utc

_FLUSH_S = 0.5
#: How often `keep` is to be called, s: with what it waits for all is on the disk within 0.25 s.
KEEP_S = 0.15
#: Eight minutes of rows; of a longer run they are read from its file when somebody wants them.
MOST_KEPT_BYTES = 1 << 26
_LOOK_S = 2.0  # what clocks do shows in seconds


class Recorder:
    """Writes raw frames as they come and rows of samples every half second, or as often as is asked.

    The first stream is the time base. `start_s` is the bench time at which its first sample came; recording
    times count samples from there, at the pace of the time base's own clock.

    Args:
        promptly: the recording is of a bench that no one can repeat: `keep` will be called every `KEEP_S`,
            and what it has written survives a power cut a quarter of a second later.
        clock_0_ns: wall-clock time at the zero of the bench clock, ns since 1970.
        between: called between parts of long work.
    """

    def __init__(
        self,
        path: Path,
        streams: Sequence[Stream],
        buses: list[str],
        sample_time_s: float,
        *,
        promptly: bool = False,
        clock_0_ns: int = 0,
        between: Callable[[], None] = lambda: None,
    ) -> None:
        self._assembler = SampleAssembler(streams, sample_time_s)
        self.writer = RecordingWriter(
            path,
            self._assembler.names,
            buses,
            durable=promptly,
            clock_0_ns=clock_0_ns,
            between=between,
        )
        self._clock_0_ns, self._between = clock_0_ns, between
        self._flush_s = np.inf if promptly else _FLUSH_S
        self._base = streams[0]
        self._chunks: list[npt.NDArray[np.float64]] | None = []  # None: too many, the file has them
        self._kept_bytes = 0
        self._last_row_s = 0.0
        self._flushed_s = self._looked_s = -np.inf
        self.start_s: float | None = None
        self._begun = False
        self._parted = False
        self.events: list[Event] = []

    def take_frames(self, bus: str, block: FrameBlock) -> None:
        """Record the raw frames of one bus."""
        self.writer.add_frames(bus, block)

    def take(self, samples: Samples) -> None:
        """Record samples of any source; those before `begin` only tell how the devices' clocks go.

        Raises:
            BenchError: a device's count of samples and their arrival have parted; raised once.
        """
        if not self._begun:
            self._assembler.learn(samples)
            return
        self._assembler.add(samples)
        if samples.stream is not self._base:
            return
        if self.start_s is None:
            self.start_s = self._flushed_s = self.writer.row_0_s = float(samples.time_s[0])
        latest_s = float(samples.time_s[-1])
        if latest_s - self._flushed_s > self._flush_s:
            self._flushed_s = latest_s
            self._write_rows()
        if latest_s - self._looked_s > _LOOK_S:
            self._looked_s = latest_s
            self._between()
            self._look_at_clocks()
            self._between()

    def begin(self) -> None:
        """Keep samples from the next ones on: every device is giving its channels now."""
        self._begun = True

    def keep(self) -> None:
        """Write all that came, so that a killed process loses none of it."""
        if self.start_s is not None:
            self._write_rows()
        self.writer.flush()
        self._between()

    def store_source(self, name: str, path: Path) -> None:
        """Say of an attachment where its file lies and what it is there: so a later change is seen."""
        with contextlib.suppress(HilError):  # it came from elsewhere, or is gone already
            table = {"path": str(path.resolve()), "sha256": sha256_of(path)}
            self.writer.describe(f"{SOURCE}{name}", table)

    def event(self, clock_s: float, kind: str, text: str) -> None:
        """Record what happened at a time of the bench clock."""
        event = Event(self.recording_time(clock_s), kind, text)
        self.events.append(event)
        self.writer.add_event(event.time_s, kind, text, logged_s=max(0.0, clock_s))

    def recording_time(self, clock_s: float) -> float:
        """Time in the recording, on its millisecond grid, of the next sample after a bench time."""
        if self.start_s is None:
            return 0.0
        time_s = self._assembler.time_of(clock_s)
        return max(0.0, round(clock_s - self.start_s if time_s is None else time_s, 3))

    def clocks(self) -> tuple[StreamClock, ...]:
        """How the samples of each counted stream lay in time; the time base first."""
        return tuple(
            StreamClock(
                stream=timing.stream.label,
                where=timing.stream.where,
                counted_by=timing.stream.counting.by if timing.stream.counting else "its own frames",
                offset_s=round(timing.offset_s, 6) + 0.0,
                drift_ppm=round(timing.drift_ppm, 1) + 0.0,  # no -0.0
                latest_s=round(timing.latest_s, 6),
                lost=timing.lost,
                left_out=timing.left_out,
            )
            for timing in self._assembler.timings()
        )

    def time_base(self) -> dict[str, str]:
        """How raw frames, which keep their stamps, lie against the rows: a table for the recording."""
        clocks = self._assembler.timings()
        row_0_s = self._assembler.bench_time_s(0.0)
        if not clocks or row_0_s is None:
            return {}
        return {
            "time_s": "counts the samples of the time base",
            "raw_frames": "stamps of the adapter on the bench clock",
            "row_0_at": utc(self._clock_0_ns + round(row_0_s * 1e9)),
            "bench_clock_0_at": utc(self._clock_0_ns),
            "bench_clock_at_row_0_s": f"{row_0_s:.6f}",
            "bench_clock_s_per_time_s": f"{1 + clocks[0].drift_ppm * 1e-6:.7f}",
        }

    def finish_rows(self) -> Recording:
        """Write what is left; the whole run's channels, for judging."""
        self._write_rows(everything=True)
        if self._assembler.late and self.start_s is not None:
            text = f"{self._assembler.late} samples arrived too late for their row and were discarded"
            self.event(self.start_s + self._last_row_s, "late", text)
        return self.so_far()

    def so_far(self) -> Recording:
        """The channels written until now."""
        self._write_rows()
        self.writer.flush()  # what asks may take long, and the process be killed meanwhile
        return Recording(self._channels(), self.writer.path, events=list(self.events))

    def _channels(self) -> MutableMapping[str, npt.NDArray[np.float64]]:
        if self._chunks is None:
            self.writer.settle()
            return read_as_written(self.writer.path).channels
        names = self._assembler.names
        rows = np.concatenate(self._chunks) if self._chunks else np.zeros((0, len(names)))
        assert names[0] == TIME
        return {name: np.ascontiguousarray(rows[:, column]) for column, name in enumerate(names)}

    def _remember(self, rows: npt.NDArray[np.float64]) -> None:
        """Keep rows at hand, as long as they are few."""
        self._last_row_s = float(rows[-1, 0])
        self._kept_bytes += rows.nbytes
        if self._kept_bytes > MOST_KEPT_BYTES:
            self._chunks = None
        if self._chunks is not None:
            self._chunks.append(rows)

    def _look_at_clocks(self) -> None:
        if self._parted:
            return
        try:
            self._assembler.look_for_parted_clocks()
        except BenchError:
            self._parted = True  # on the way to the safe state it is known
            raise

    def _write_rows(self, *, everything: bool = False) -> None:
        rows = self._assembler.rows(everything=everything, between=self._between)
        self._between()
        if len(rows):
            self.writer.add_rows(rows)
            self._remember(rows)
            self._between()
