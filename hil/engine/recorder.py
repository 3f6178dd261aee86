"""Takes every frame of a run into the recording, and decodes it on the way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from drivers import Binding, SampleAssembler
from hil.core.channels import TIME
from hil.core.frames import FrameBlock, standard
from hil.core.recording import Event, Recording, RecordingWriter

_FLUSH_S = 0.5


class Recorder:
    """Writes raw frames as they come and decoded samples every half second.

    `start_s` is the bench time of the first sample; recording times count from there.
    """

    def __init__(self, path: Path, bindings: list[Binding], buses: list[str], sample_time_s: float) -> None:
        self._assembler = SampleAssembler(bindings, sample_time_s)
        self.writer = RecordingWriter(path, self._assembler.names, buses)
        self._master = (bindings[0].bus, bindings[0].frame_id)
        self._chunks: list[npt.NDArray[np.float64]] = []
        self._flushed_s = -np.inf
        self.start_s: float | None = None
        self._decoding = False
        self.events: list[Event] = []

    def take(self, bus: str, block: FrameBlock) -> None:
        """Record the frames of one bus."""
        latest_s = float(block["time_s"][-1])
        self.writer.add_frames(bus, block)
        if not self._decoding:
            return
        self._assembler.add(bus, block)
        if self.start_s is None and bus == self._master[0]:
            usual = standard(block)
            first = usual[usual["id"] == self._master[1]]
            if len(first):
                self.start_s = float(first["time_s"][0])
                self._flushed_s = latest_s
        if latest_s - self._flushed_s > _FLUSH_S:
            self._flushed_s = latest_s
            self._write_rows()

    def begin(self) -> None:
        """Decode from the next frames on: every device is giving its channels now."""
        self._decoding = True

    def event(self, clock_s: float, kind: str, text: str) -> None:
        """Record what happened at a time of the bench clock."""
        event = Event(self.recording_time(clock_s), kind, text)
        self.events.append(event)
        self.writer.add_event(event.time_s, kind, text)

    def recording_time(self, clock_s: float) -> float:
        """Time in the recording, on its millisecond grid, of the next sample after a bench time."""
        if self.start_s is None:
            return 0.0
        return max(0.0, round(clock_s - self.start_s, 3))

    def finish_rows(self) -> Recording:
        """Decode what is left; the whole run's channels, for judging."""
        self._write_rows(everything=True)
        return self.so_far()

    def so_far(self) -> Recording:
        """The channels decoded until now."""
        self._write_rows()
        names = self._assembler.names
        rows = np.concatenate(self._chunks) if self._chunks else np.zeros((0, len(names)))
        channels = {name: np.ascontiguousarray(rows[:, column]) for column, name in enumerate(names)}
        assert names[0] == TIME
        return Recording(channels, self.writer.path, events=list(self.events))

    def _write_rows(self, *, everything: bool = False) -> None:
        rows = self._assembler.rows(everything=everything)
        if len(rows):
            self.writer.add_rows(rows)
            self._chunks.append(rows)
