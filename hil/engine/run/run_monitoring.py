"""Monitors a bench during a run (samples, limits, silence, devices, operator), and keeps what stopped it."""

from __future__ import annotations

import contextlib
import traceback
from collections.abc import Callable

from drivers import SaysEmergency
from hil.core.errors import BenchError, EmergencyStopError, HilError, InterruptError
from hil.engine.bench.bench import Bench
from hil.engine.bench.ranges import Range
from hil.engine.run.hold import Holding
from hil.engine.run.limits import LimitWatch
from hil.engine.run.liveness import LivenessWatch
from hil.engine.run.operator import LOOK_S, Operator
from hil.engine.run.recorder import Recorder
from hil.engine.run.run_down import AxleSpeeds
from hil.engine.run.zero import ZeroCheck


class Failures:
    """Keeps what stopped a run: the first failure, or the emergency stop that came after it.

    Args:
        event: takes an event of the recording; a disk that is full is no news here.
        blame: what to say of a failure whose cause may be that the loop itself stood still; '' if it is not.
    """

    def __init__(self, event: Callable[[str, str], None], blame: Callable[[], str]) -> None:
        self._event, self._blame = event, blame
        self.error: HilError | None = None

    def take(self, error: Exception) -> None:
        """Something went wrong; what is not an error of ours is a mistake in the program."""
        if not isinstance(error, HilError):
            self.note(error)
            error = BenchError(f"internal error: {type(error).__name__}: {error}", fix="please report it")
        if self.error is not None and not isinstance(error, EmergencyStopError):
            return
        self.error = self._with_blame(error)
        self.tell(_kind_of(error), str(self.error).replace("\n", " "))

    def note(self, error: Exception) -> None:
        """A fault of ours, or of a device's code: where it happened stands in the recording."""
        self.tell("traceback", "".join(traceback.format_exception(error)))

    def tell(self, kind: str, text: str) -> None:
        """Record an event, if the recording still takes any."""
        with contextlib.suppress(Exception):  # that it takes none is already being reported
            self._event(kind, text)

    def _with_blame(self, error: HilError) -> HilError:
        if type(error) is not BenchError or "the bench loop was delayed" in error.what:
            return error
        pause = self._blame()
        return BenchError(f"{error.what} ({pause})", where=error.where, fix=error.fix) if pause else error


def _kind_of(error: HilError) -> str:
    if isinstance(error, EmergencyStopError):
        return "emergency_stop"
    return "interrupt" if isinstance(error, InterruptError) else "failure"


_DEVICES_S = 0.05


class RunMonitoring:
    """Hands every sample to who needs it, and answers to what is not as it should be.

    Attributes:
        going_safe: devices' troubles are no news any more.
        rows_finished: what comes is no part of the recording's rows any more.
    """

    def __init__(
        self, bench: Bench, recorder: Recorder, operator: Operator, event: Callable[[str, str], None]
    ) -> None:
        self._bench, self._recorder, self._operator, self._event = bench, recorder, operator, event
        file = bench.file
        self.limits = LimitWatch(bench.streams, file.limits, file.interlocks, self._answer, self._troubles)
        self.liveness = LivenessWatch(bench.streams)
        self.zero = ZeroCheck(bench.streams, file.zero)
        self.hold = Holding(bench.loop, operator, self.limits.standing, event, recorder.recording_time)
        self._sources = bench.sources
        # asked of the class once: a look at a protocol's names costs more than all else here
        self._say_emergency = [device for device in bench.devices if isinstance(device, SaysEmergency)]
        self.going_safe = self.rows_finished = False
        self._run_down: AxleSpeeds | None = None
        bench.loop.on_block(recorder.take_frames)
        bench.loop.on_drained(self._take_samples)

    def begin(self) -> None:
        """The bench is armed: look at the devices and the operator from now on."""
        self._bench.loop.every(_DEVICES_S, self._supervise)
        if self._operator.present:
            self._bench.loop.every(LOOK_S, self._operator.look)

    def end(self) -> None:
        """What is beyond a limit is being taken down, and devices may say what they like."""
        self.going_safe = True
        self.limits.active = False

    def begin_run_down(self) -> AxleSpeeds:
        """The bench is safe after a stop: what comes is recorded, and changes no result of the run."""
        self._run_down = AxleSpeeds(self._bench.streams, self._bench.loop.clock.now_s)
        return self._run_down

    @property
    def running_down(self) -> bool:
        """Whether what comes now was measured after a stop."""
        return self._run_down is not None

    def _answer(self, reached: Range, text: str) -> None:
        """What is done when a limit is reached that is no trip, or an interlock is lost."""
        self._event("limit", f"{reached.name}: {text}; response: {reached.response}")
        if reached.response == "emergency_stop":
            what, by = f"{text}; {reached.message}", f"interlock '{reached.name}'"
            raise EmergencyStopError(what, by=by, origin=reached.name, way="interlock")
        if reached.response == "ramp_down":
            self.hold.end_run(text)
        elif reached.response in ("pause", "hold"):
            self.hold.ask(reached, text)
        else:
            self._operator.tell(f"warning: {text}")

    def _troubles(self) -> str:
        return "; ".join(text for device in self._bench.devices for text in device.troubles())

    def _supervise(self) -> None:
        if self.limits.standing_still(self._bench.loop.clock.now_s()):
            return  # what came meanwhile is to be looked at first
        if self.going_safe:
            return
        for one in self._say_emergency:
            if one.emergency:
                raise EmergencyStopError(one.emergency, by=one.name, origin=one.name, way="device")
        for device in self._bench.devices:
            troubles = device.troubles()
            if troubles:
                raise BenchError("; ".join(troubles), where=device.name, fix=f"check {device.name}")

    def _take_samples(self) -> None:
        """Whoever measured: all is recorded, all is watched."""
        now_s = self._bench.loop.clock.now_s()
        for source in self._sources:
            for samples in source.samples():
                for computed in self._bench.computed:
                    computed.take(samples)
                self.zero.take(samples)
                if not self.rows_finished:
                    self._recorder.take(samples)
                if self._run_down is not None:
                    self._run_down.take(samples)
                    continue
                self.limits.take(samples, now_s)
                self.liveness.take(samples)
            self._bench.loop.keep_up()
        if self.limits.active and not self._bench.rmcu.is_safe():
            self.liveness.refuse_frozen()
        pauses = self.limits.pauses.count
        try:
            self.limits.look_for_silence(now_s)
        finally:
            if self.limits.pauses.count > pauses:
                self._event("pause", f"the bench loop was delayed by {self.limits.pauses.last_s:.2g} s")
