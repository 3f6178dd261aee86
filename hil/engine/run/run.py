"""A run from pre-flight to the closed recording, and what happens when something goes wrong on the way."""

from __future__ import annotations

import contextlib
import datetime
import time
from functools import partial

from drivers import TICK_S, SaysDamage
from hil.core.errors import (
    BadInputError,
    BenchError,
    HilError,
    InterruptError,
    LimitTripError,
    OrderlyEndError,
)
from hil.core.errors.wording import LONGEST_REASON, refuse_long
from hil.core.files import make_directory
from hil.core.recording import Recording
from hil.core.result import (
    AcceptedExpiry,
    CriterionResult,
    RunResult,
    SafeState,
    Timing,
    verdict_of,
)
from hil.core.runtime.clock import utc
from hil.engine.bench.bench import Bench, open_bench, refuse_needs
from hil.engine.bench.bench_channels import accepted_expiry
from hil.engine.bench.bus_tally import BusLoads
from hil.engine.bench.request_timing import COLLECT_S, RequestTiming
from hil.engine.ipc.ipc import RECORDING, RunOutcome, RunRequest, analysed_apart, analysed_here
from hil.engine.run.arming import Arming
from hil.engine.run.operator import GONE_REASON, Operator
from hil.engine.run.preflight import channels_of, preflight, refuse_unconfirmed
from hil.engine.run.recorder import Recorder
from hil.engine.run.run_down import follow_run_down
from hil.engine.run.run_files import store_expiry, store_inputs, store_result
from hil.engine.run.run_monitoring import Failures, RunMonitoring
from hil.engine.run.safety import reach_safe_state
from hil.engine.run.step_execution import BenchConductor
from hil.engine.stop.emergency_stop import keep_latched, refuse_latched
from test_plans import estimate_duration_s, judge, not_checked

_PROGRESS_S = 0.5


def run_plan(request: RunRequest) -> RunOutcome:
    """Execute a plan on a bench and write its recording.

    The order of events is described in docs/reference/order-of-events.md.

    Raises:
        BadInputError: before anything was moved: plan, bench or place cannot be used.
        BenchError: before anything was moved: the bench does not come up.
    """
    with request.stop.by_signals():
        make_directory(request.out)
        today = datetime.datetime.now(datetime.UTC).date()
        for option, name in (
            ("--operator", request.operator),
            ("--yes", request.confirmed_by),
            ("--confirm", request.hazard_confirmed_by),
        ):
            refuse_long(name, option)
        refuse_long(request.accept_expired, "--accept-expired", LONGEST_REASON)
        answers = request.terminal is not None or request.confirmed_by != ""
        expired = accepted_expiry(request.bench, today, request.accept_expired)
        preflight(request.plan, request.bench, request.out, model=request.model, somebody_answers=answers)
        refuse_unconfirmed(request.plan, request.hazard_confirmed_by)
        refuse_latched(request.bench, request.stops)
        with open_bench(request.bench, model=request.model) as bench:
            refuse_needs(bench, channels_of(request.plan))
            for path in request.replaces:
                path.unlink(missing_ok=True)
            with request.stop.telling(partial(setattr, bench.loop, "stop_requested", True)):
                return _Run(request, bench, expired).execute()


class _Run:
    def __init__(self, request: RunRequest, bench: Bench, expired: AcceptedExpiry | None) -> None:
        self._request, self._bench, self._expired = request, bench, expired
        self._unsafe: list[str] = []
        self._unwatched = False
        self._end_steps = ""

    def execute(self) -> RunOutcome:
        self._prepare()
        bench = self._bench
        started = time.perf_counter()
        self._begin_s = bench.loop.clock.now_s()
        try:
            self._arming.come_up()
            self._begin_duties()
            started = time.perf_counter()
            self._begin_s = bench.loop.clock.now_s()
            self._steps()
        except Exception as error:  # also a fault of ours must leave a safe bench and say what it was
            self._failures.take(error)
        finally:
            # Also when the interpreter itself is going down: no one may be left with torque on.
            bench.loop.shielded = True
            self._watch.end()
            self._unsafe = reach_safe_state(bench, self._failures.note) if self._arming.armed else []
            if self._request.watched is not None:
                self._request.watched.concluded(armed=self._arming.armed, unsafe=self._unsafe)
            request = self._request
            self._stopped = keep_latched(self._failures.error, request.bench, request.out, request.stops)
            self._tell_safe_state()
        self._run_down()
        return self._finish(time.perf_counter() - started)

    def _prepare(self) -> None:
        request, bench = self._request, self._bench
        buses = [wire.name for wire in bench.loop.wires]
        clock = bench.loop.clock
        self._recorder = Recorder(
            request.out / RECORDING,
            bench.streams,
            buses,
            TICK_S,
            promptly=not clock.virtual,
            clock_0_ns=time.time_ns() - round(clock.now_s() * 1e9),
            between=bench.loop.keep_up,
        )
        self._started_at = utc(time.time_ns())
        self._inputs = store_inputs(self._recorder, request, bench, self._started_at)
        if self._expired:
            store_expiry(self._recorder, self._expired)
        # In virtual time nothing can be late.
        self._timing = (
            None
            if bench.simulated
            else RequestTiming(bench.loop.clock, bench.loop.wires, self._recorder.writer.add_requests)
        )
        noted = bench.torque_requests(self._timing, TICK_S) if self._timing else None
        operator = Operator(bench.loop, request.terminal, request.confirmed_by, self._turned)
        self._failures = Failures(self._event, self._blame)
        rates = {name: request.bench.buses[name].bit_rate for name in buses}
        self._bus_loads = BusLoads(rates, clock.now_s)
        bench.loop.on_block(self._bus_loads.take_frames)
        self._watch = RunMonitoring(bench, self._recorder, operator, self._failures.tell)
        self._conductor = BenchConductor(
            bench,
            self._recorder,
            request.out,
            operator.confirm,
            request.analyse or (analysed_here if bench.simulated else analysed_apart),
            noted,
            self._watch.hold,
            operator.wait_for,
        )
        self._arming = Arming(
            bench, self._recorder, self._watch.limits, self._watch.zero, self._timing, self._turned
        )

    def _begin_duties(self) -> None:
        loop = self._bench.loop
        self._watch.begin()
        loop.every(_PROGRESS_S, self._show_progress)
        if self._timing:
            loop.every(COLLECT_S, self._timing.collect)
        self._expected_s = estimate_duration_s(self._request.plan)

    def _turned(self) -> None:
        """Tell who watches this process that the loop turns; no one may drive a bench unwatched."""
        gone = self._request.watched.turned() if self._request.watched is not None else ""
        if not gone:
            return
        loop = self._bench.loop
        if loop.shielded:
            loop.stop_requested = True  # a prompt among the end steps is not waited for
        elif not self._unwatched:
            self._unwatched = True
            raise OrderlyEndError(
                gone, where="supervision", fix="make the reports of this run with hil report"
            )

    def _tell_safe_state(self) -> None:
        if self._arming.armed:
            self._failures.tell("safe_state", "; ".join(self._unsafe) or f"confirmed by {self._arming.names}")

    def _run_down(self) -> None:
        """After a stop the axle may still turn: record that, with every device safe, for a limited time."""
        request, failures = self._request, self._failures
        longest_s = request.bench.supervision.run_down_s
        nobody_waits = self._bench.loop.stop_reason == GONE_REASON
        if failures.error is None or self._unsafe or not self._arming.armed or nobody_waits or not longest_s:
            return
        speeds = self._watch.begin_run_down()
        try:
            self._unsafe = follow_run_down(self._bench, speeds, longest_s, failures.note, failures.tell)
        except HilError as error:  # also an emergency stop, which has reached a bench that is safe already
            failures.take(error)
        except Exception as error:  # a mistake in the program, which may be what ended the run
            failures.tell("run_down", f"internal error: {type(error).__name__}: {error}")
        if self._stopped is None:
            self._stopped = keep_latched(failures.error, request.bench, request.out, request.stops)
        if self._unsafe:
            self._tell_safe_state()

    def _look_at_drift(self) -> None:
        """The drives are off; what comes from here on is no part of the run's rows."""
        try:
            failed = isinstance(self._failures.error, BenchError)
            self._watch.zero.after(self._bench.loop, ended_well=not self._unsafe and not failed)
        except Exception as error:  # the recording is to be closed with what was measured
            self._failures.take(error)

    def _steps(self) -> None:
        """The plan's steps; whatever ends them, its end steps too, unless nothing should move any more."""
        plan, conductor = self._request.plan, self._conductor
        try:
            for step in plan.steps:
                step.execute(conductor)
            self._watch.hold.refuse_end()
        except (InterruptError, BadInputError, OrderlyEndError) as error:
            self._end_early(error)
        except HilError:
            self._end_steps = "not executed: nothing may move on a bench that has failed"
            raise
        except Exception as error:  # a mistake in a step's code: the bench is well
            self._end_early(error)
        self._watch.hold.active = False
        self._end_steps = "started, but not completed"
        for step in plan.finally_:
            step.execute(conductor)
        self._end_steps = self._read_back()
        self._event("end_steps", self._end_steps)
        self._watch.hold.refuse_end()

    def _end_early(self, error: Exception) -> None:
        """Torque off; the end steps that follow are not to be disturbed."""
        self._failures.take(error)
        self._bench.loop.shielded = True
        self._bench.rmcu.make_safe()

    def _read_back(self) -> str:
        """What the end steps have left, as the devices say."""
        names = ", ".join(step.kind for step in self._request.plan.finally_) or "none"
        speed, state = self._bench.dyno.wheel_speed_rad_s, self._bench.rmcu.state
        return f"executed: {names}; the wheels turn at {abs(speed):.2f} rad/s, the RMCU is in '{state}'"

    def _show_progress(self) -> None:
        passed_s = self._bench.loop.clock.now_s() - self._begin_s
        segments = self._conductor.segments
        text = segments[-1].id if segments else "coming up"
        text = f"held: {self._watch.hold.causes_shown}" if self._watch.hold.causes_shown else text
        text = "the axle runs down" if self._watch.running_down else text
        self._request.progress(min(1.0, passed_s / max(self._expected_s, 1e-9)), text)

    def _blame(self) -> str:
        """What may be the cause of a failure, whatever it looks like."""
        pause = self._watch.limits.pauses.blamed_at(self._bench.loop.clock.now_s())
        return "; ".join(filter(None, [pause, *self._damage()]))

    def _damage(self) -> list[str]:
        """Frames that came damaged and were left out, as devices say."""
        found = (device.damage for device in self._bench.devices if isinstance(device, SaysDamage))
        return [text for text in found if text]

    def _event(self, kind: str, text: str) -> None:
        self._recorder.event(self._bench.loop.clock.now_s(), kind, text)

    def _finish(self, wall_s: float) -> RunOutcome:
        request, loop = self._request, self._bench.loop
        safe: SafeState = "not_needed"
        if self._arming.armed:
            safe = "not_confirmed" if self._unsafe else "confirmed"
        failures = self._failures
        if self._unsafe and not isinstance(failures.error, BenchError):
            failures.error = BenchError(
                "; ".join(self._unsafe),
                where="safe state",
                fix="cut the drives' power before you approach the bench",
            )
        for wire in loop.wires:
            for remark in wire.remarks:
                self._failures.tell("bus", f"{wire.name}: {remark}")
        damage = self._damage()
        for text in damage:
            self._failures.tell("bus", text)
        bench_time_s = loop.clock.now_s() - self._begin_s
        recording = self._recording()
        self._watch.rows_finished = True
        self._look_at_drift()
        criteria = self._judged(recording) if recording is not None else ()
        tripped = failures.error.what if isinstance(failures.error, LimitTripError) else ""
        verdict = verdict_of(criteria, stopped=failures.error is not None, limit_tripped=tripped)
        result = RunResult(
            verdict=verdict,
            plan=request.plan.name,
            bench=request.bench.name,
            started_at=self._started_at,
            real_time_factor=round(bench_time_s / max(wall_s, 1e-9), 2),
            bench_time_s=round(bench_time_s, 3),
            safe_state=safe,
            variables=request.plan.values,
            criteria=criteria,
            segments=tuple(self._conductor.segments),
            clocks=self._recorder.clocks(),
            timing=self._timed(),
            bus_loads=self._bus_loads.results(),
            identities=self._arming.identities,
            zeros=self._watch.zero.zeros,
            limits=self._watch.limits.results,
            holds=tuple(self._watch.hold.holds),
            emergency_stop=self._stopped,
            end_steps=self._end_steps,
            missing=(*self._arming.missing, *damage),
            not_checked=not_checked(request.plan, recording, self._conductor.segments) if recording else (),
            accepted_expired=self._expired,
            reason=str(failures.error) if failures.error else "",
            limit_tripped=tripped,
        )
        try:
            store_result(self._recorder, self._inputs, self._conductor, result)
        except Exception as error:  # the result is reported all the same
            failures.take(error)
        largest = dict(self._watch.limits.largest)
        at_fault = (
            isinstance(failures.error, LimitTripError) and verdict == "fail"
        )  # the device, not the bench
        ended_by = None if at_fault else failures.error
        return RunOutcome(result, request.out / RECORDING, ended_by, largest, tuple(self._conductor.made))

    def _timed(self) -> Timing:
        """How well the loop kept time; what is left of it is recorded."""
        if self._timing is None:
            return Timing(clock="virtual")
        with contextlib.suppress(HilError):  # a full disk is already being reported
            self._timing.collect(everything=True)
        pauses = self._watch.limits.pauses
        return Timing(
            clock="wall",
            requests=self._timing.results(),
            pauses=pauses.count,
            longest_pause_s=round(pauses.longest_s, 3),
        )

    def _judged(self, recording: Recording) -> tuple[CriterionResult, ...]:
        try:
            return judge(self._request.plan, recording, self._conductor.segments)
        except Exception as error:  # the recording is to be closed with what was measured
            self._failures.take(error)
        return ()

    def _recording(self) -> Recording | None:
        try:
            return self._recorder.finish_rows()
        except Exception as error:  # what was measured until now is on the disk
            self._failures.take(error)
            return None
