"""A plan executed on a bench that is computed, not talked to: what a run would record, in a fraction of
its time.

The engine's own conductor does it, with a predicted bench in place of drivers and wire.
"""

from __future__ import annotations

import copy
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, MutableMapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from hil.core.channels import TIME
from hil.core.controller import Controller
from hil.core.model import Model
from hil.core.recording import Event, Recording
from hil.core.result import Segment
from hil.core.vehicle import VehicleAndRoad
from hil.engine.bench.bench import Bench
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.prediction._predicted_bench import PredictedBench
from hil.engine.prediction._predicted_wire import PredictedWire
from hil.engine.run.recorder import Recorder
from hil.engine.run.step_execution import BenchConductor, release_from
from hil.plant import LONGEST_STEP_S
from hil.plant.closed_loop import TICK_S, Noise
from test_plans import Array, Plan, PlannedSegment, Quantity, Step

_UNSETTLED_S = 0.003  # what came later than this before the newest sample is not in a recording so far
_AROUND_S = 2.0  # of the rows around a segment: what metrics and filters look at
#: Is given a segment that has ended, and a recording of its rows.
TakesSegment = Callable[[Recording, Segment], None]


@dataclass(frozen=True)
class Prediction:
    """What a run would record.

    `recording` has the channels of a run, without sensor noise; `peaks` are largest magnitudes of the
    channels that limits watch, in their units; `made` are the files of analysis steps; `bus_loads` are
    shares of the buses that the frames of every millisecond take, at most.
    """

    recording: Recording
    segments: tuple[Segment, ...]
    peaks: dict[str, float]
    made: Mapping[str, bytes]
    bus_loads: dict[str, float]


def predict(
    plan: Plan,
    bench: BenchFile,
    model: Model,
    *,
    controllers: Mapping[Path, Controller] | None = None,
    noise: Noise | None = None,
    channels: Collection[str] | None = None,
    longest_step_s: float = LONGEST_STEP_S,
    wire: PredictedWire | None = None,
) -> Prediction:
    """Carry `plan` out on the simulated bench of `bench` and `model`, without its wire and its noise.

    No one is asked at operator prompts, and no limit on measured values trips.

    Args:
        controllers: what is loaded in place of files that the plan loads.
        noise: of the sensors; none without it.
        channels: those of the recording that are wanted, then without `peaks`; all without it.
        longest_step_s: of the integrator.
        wire: what `wire_of` the bench gave, if somebody has it already.

    Raises:
        BadInputError: the plan asks for more than the bench allows, or a model without a shaft.
        HilError: the run would fail.
    """
    with tempfile.TemporaryDirectory() as directory:
        run = PredictedRun(
            PredictedBench(bench, model, noise, longest_step_s, wire), Path(directory), channels, controllers
        )
        run.execute((*plan.steps, *plan.finally_))
        return run.ended()


class PredictedRun:
    """A run that is predicted step by step.

    Args:
        bench: armed, at rest.
        out: folder in which analysis steps find what earlier ones made.
        channels: those of the recording that are wanted; all without it.
        controllers: what is loaded in place of files that the plan loads.
        each_segment: is given each segment as it ends.
        keeps_rows: else those of what is over are dropped, and the recording holds the last rows alone.
    """

    def __init__(
        self,
        bench: PredictedBench,
        out: Path,
        channels: Collection[str] | None = None,
        controllers: Mapping[Path, Controller] | None = None,
        each_segment: TakesSegment | None = None,
        *,
        keeps_rows: bool = True,
    ) -> None:
        self._bench, self._channels = bench, channels
        self._recorder = _PredictedRecorder(bench, channels)
        self._conductor = PredictionConductor(bench, self._recorder, out, controllers, each_segment)
        if not keeps_rows:
            bench.loop.after_block = self._forget_what_is_over

    def execute(self, steps: Iterable[Step]) -> None:
        """Carry steps out, from where the run stands.

        Raises:
            HilError: the run would fail.
        """
        for step in steps:
            step.execute(self._conductor)

    def continued(self, room: Array, out: Path, controllers: Mapping[Path, Controller]) -> PredictedRun:
        """A run of its own that goes on from here, in folder `out`; its rows stand in `room`."""
        bench, closed = self._bench, self._bench.loop.closed
        shared = (bench.file, bench.model, bench.wire, bench.wire.dictionary, bench.wire.parameters)
        run = copy.deepcopy(self, {id(one): one for one in shared} | {id(closed): closed.continued(room)})
        run._conductor.go_on(out, controllers)
        return run

    def _forget_what_is_over(self) -> None:
        self._bench.forget(self._bench.loop.closed.samples - round(_AROUND_S / TICK_S))

    @property
    def rows(self) -> Array:
        """What was measured and commanded so far."""
        return self._bench.loop.closed.rows

    def free_rows(self) -> None:
        """Free the memory of what was measured; the run cannot go on."""
        self._bench.loop.closed.free_rows()

    def ended(self) -> Prediction:
        """What the run would have recorded, once the bench is safe."""
        bench, conductor = self._bench, self._conductor
        bench.rmcu.make_safe()
        bench.dyno.make_safe()
        peaks = bench.peaks() if self._channels is None else {}
        return Prediction(
            self._recorder.everything(), tuple(conductor.segments), peaks, conductor.made, bench.wire.loads
        )


class PredictionConductor(BenchConductor):
    """The engine's conductor on a predicted bench; only torque is not sent millisecond by millisecond."""

    def __init__(
        self,
        bench: PredictedBench,
        recorder: _PredictedRecorder,
        out: Path,
        controllers: Mapping[Path, Controller] | None = None,
        each_segment: TakesSegment | None = None,
    ) -> None:
        super().__init__(
            cast(Bench, bench), cast(Recorder, recorder), out, lambda text, timeout_s, picture: "not asked"
        )
        self._rmcu, self._loop, self._dyno = bench.rmcu, bench.loop, bench.dyno
        self._rows_of = recorder
        self._in_place_of = controllers or {}
        self._each_segment = each_segment

    def go_on(self, out: Path, controllers: Mapping[Path, Controller]) -> None:
        """From now on work in folder `out`, and load `controllers` in place of files."""
        self._out, self._in_place_of = out, controllers

    def set_controller(self, file: Path) -> None:
        """Write a controller to the RMCU: the file's, or what is to be tried in its place."""
        tried = self._in_place_of.get(file)
        if tried is None:
            super().set_controller(file)
            return
        self._check.take(tried, str(file))
        self._rmcu.write_controller(tried)
        self._controller = tried

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """Let the computed dynos have it; a panel is not computed."""
        self._check.set_vehicle(vehicle)
        self._dyno.set_vehicle(vehicle)
        self._take_friction(vehicle)

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """Request all samples at once, then take the torque away and switch it off."""
        self._check.play(quantity, samples_nm, segment)
        if segment:
            self._begin(segment, self._loop.now_s(), len(samples_nm))
        self._rmcu.play(quantity, np.concatenate([samples_nm, release_from(samples_nm[-1])]))
        if segment:
            self._end(self._loop.now_s(), complete=True)
        self._switch_off()
        if self._each_segment and segment:
            ended = self.segments[-1]
            around = self._rows_of.between(ended.start_s - _AROUND_S, ended.end_s + _AROUND_S)
            self._each_segment(around, ended)
        self._loop.after_block()


class _ReadChannels(MutableMapping[str, Array]):
    """Channels that are computed when somebody asks for them: a criterion needs few, an hour is long."""

    def __init__(self, names: Iterable[str], known: dict[str, Array], read: Callable[[str], Array]) -> None:
        self._names, self._known, self._read = dict.fromkeys(names), known, read

    def __getitem__(self, name: str) -> Array:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __setitem__(self, name: str, values: Array) -> None:
        self._names[name] = None
        self._known[name] = values

    def __delitem__(self, name: str) -> None:
        del self._names[name]
        self._known.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class _PredictedRecorder:
    """Stands where the recorder stands: the rows are kept by the bench, attachments and events here."""

    def __init__(self, bench: PredictedBench, channels: Collection[str] | None = None) -> None:
        self._bench, self._channels = bench, channels
        self._start_s = bench.began * TICK_S + bench.wire.first_stamp_s
        self._attachments: dict[str, bytes] = {}
        self._metadata: dict[str, dict[str, str]] = {}
        self._events: list[Event] = []
        self.writer = self

    def attach(self, name: str, content: bytes) -> None:
        """Keep a file."""
        self._attachments[name] = content

    def describe(self, name: str, values: dict[str, str]) -> None:
        """Keep a table."""
        self._metadata[name] = values

    def store_source(self, name: str, path: Path) -> None:
        """Nothing: a prediction is not run again."""

    def event(self, clock_s: float, kind: str, text: str) -> None:
        """Keep what happened at a time of the bench clock."""
        self._events.append(Event(self.recording_time(clock_s), kind, text))

    def recording_time(self, clock_s: float) -> float:
        """Time in the recording, on its millisecond grid, of the next sample after a bench time."""
        return max(0.0, round(clock_s - self._start_s, 3))

    def so_far(self) -> Recording:
        """The channels that a run would have decoded until now: the newest frames are still awaited."""
        unsettled = round((_UNSETTLED_S + self._bench.wire.unsettled_s) / TICK_S + 0.5)
        return self._recording(self._bench.loop.closed.samples - unsettled)

    def everything(self) -> Recording:
        """All channels that are kept, to the last sample."""
        return self._recording(self._bench.loop.closed.samples)

    def between(self, start_s: float, end_s: float) -> Recording:
        """The channels from one time in the recording to another, as far as they are kept."""
        bench, closed = self._bench, self._bench.loop.closed
        first, last = (round((time_s + self._start_s) / TICK_S) for time_s in (start_s, end_s))
        first, last = max(first, closed.first, bench.began), min(last, closed.samples)
        time_s = np.round(np.arange(first - bench.began, last - bench.began) * TICK_S, 9)
        names = closed.recorded(first, first + 1, self._channels)
        return self._recording_of(
            _ReadChannels(names, {TIME: time_s}, lambda name: closed.recorded(first, last, {name})[name])
        )

    def _recording(self, end: int) -> Recording:
        return self._recording_of(self._bench.loop.closed.recorded(self._bench.began, end, self._channels))

    def _recording_of(self, channels: MutableMapping[str, Array]) -> Recording:
        return Recording(
            channels,
            Path("prediction"),
            metadata=dict(self._metadata),
            attachments=dict(self._attachments),
            events=list(self._events),
        )
