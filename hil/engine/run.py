"""A run from pre-flight to the closed recording, and what happens when something goes wrong on the way."""

from __future__ import annotations

import contextlib
import datetime
import time
import traceback
from functools import partial

from drivers import TICK_S, Incomplete
from hil.core.errors import BadInputError, BenchError, HilError, InterruptError
from hil.core.files import make_directory
from hil.core.model import model_to_toml
from hil.core.recording import Recording
from hil.core.result import CriterionResult, Identity, RunResult, SafeState, Timing, verdict_of
from hil.engine.bench import Bench, open_bench, refuse_needs
from hil.engine.border import RECORDING, RunOutcome, RunRequest
from hil.engine.conductor import BenchConductor
from hil.engine.identification import identities_of, refuse_others
from hil.engine.limits import LimitWatch
from hil.engine.preflight import channels_of, preflight
from hil.engine.provenance import hashes, versions
from hil.engine.recorder import KEEP_S, Recorder
from hil.engine.request_timing import COLLECT_S, RequestTiming
from hil.engine.safety import reach_safe_state
from hil.engine.warming import warm_up
from hil.engine.zero import ZeroCheck
from test_plans import estimate_duration_s, judge

_PROGRESS_S = 0.5
_LISTEN_S = 0.2
_REPEAT_S = 0.02


def run_plan(request: RunRequest) -> RunOutcome:
    """Carry out a plan on a bench and write its recording.

    The order of events is described in docs/reference/order-of-events.md.

    Raises:
        BadInputError: before anything was moved: plan, bench or place cannot be used.
        BenchError: before anything was moved: the bench does not come up.
    """
    with request.stop.by_signals():
        make_directory(request.out)
        today = datetime.datetime.now(datetime.UTC).date()
        answers = request.ask is not None or request.confirmed_by != ""
        preflight(request.plan, request.bench, request.out, today, somebody_answers=answers)
        with open_bench(request.bench, model=request.model) as bench:
            refuse_needs(bench, channels_of(request.plan))
            for path in request.replaces:
                path.unlink(missing_ok=True)
            with request.stop.telling(partial(setattr, bench.loop, "stop_requested", True)):
                return _Run(request, bench).carry_out()


class _Run:
    def __init__(self, request: RunRequest, bench: Bench) -> None:
        self._request, self._bench = request, bench
        *others, last = [device.name for device in bench.devices]
        self._names = f"{', '.join(others)} and {last}"
        self._error: HilError | None = None
        self._unsafe: list[str] = []
        self._armed = False
        self._identities: tuple[Identity, ...] = ()
        self._zero = ZeroCheck(bench.streams, request.bench.zero)
        self._rows_finished = False
        self._missing: tuple[str, ...] = ()
        self._started_at = datetime.datetime.now(datetime.UTC)

    def carry_out(self) -> RunOutcome:
        request, bench = self._request, self._bench
        buses = [wire.name for wire in bench.loop.wires]
        self._recorder = Recorder(
            request.out / RECORDING, bench.streams, buses, TICK_S, promptly=not bench.simulated
        )
        self._recorder.between = bench.loop.keep_up
        self._watch = LimitWatch(bench.streams, request.bench.limits)
        self._store_inputs()
        # In virtual time nothing can be late.
        self._timing = (
            None
            if bench.simulated
            else RequestTiming(bench.loop.clock, bench.loop.wires, self._recorder.writer.add_requests)
        )
        noted = bench.torque_requests(self._timing, TICK_S) if self._timing else None
        self._conductor = BenchConductor(
            bench, self._recorder, request.out, self._prompt, request.analyse, noted
        )
        bench.loop.on_block(self._recorder.take_frames)
        bench.loop.on_drained(self._take_samples)
        started = time.perf_counter()
        try:
            self._come_up()
            started = time.perf_counter()
            self._begin_s = bench.loop.clock.now_s()
            self._steps()
        except HilError as error:
            self._fail(error)
        except Exception as error:  # a fault of ours must leave a safe bench and say what it was
            self._fail_by(error)
        finally:
            # Also when the interpreter itself is going down: nobody may be left with torque on.
            bench.loop.shielded = True
            self._watch.active = False  # its work is done: what is beyond a limit is being taken down
            self._unsafe = reach_safe_state(bench, self._note_fault) if self._armed else []
        return self._finish(time.perf_counter() - started)

    def _prompt(self, text: str) -> str:
        """Have a prompt confirmed; says by whom or by what."""
        request = self._request
        if request.confirmed_by:
            return f"confirmed beforehand by {request.confirmed_by}"
        if request.ask is None:
            return "nobody to ask: a simulated bench goes on"
        request.ask(text)
        return "confirmed by the operator"

    def _come_up(self) -> None:
        bench = self._bench
        self._begin_s = bench.loop.clock.now_s()
        self._identify()
        if not bench.simulated:
            warm_up(bench)
            bench.loop.every(KEEP_S, self._recorder.keep)
        bench.start_heartbeats(self._timing)
        bench.rmcu.come_up()
        bench.dyno.come_up()
        for device in bench.further.values():
            self._armed = True  # what a further device does once it is up, only the device knows
            device.come_up()
        self._note_missing()
        refuse_others(self._identities)
        self._recorder.begin()
        self._zero.begin()
        bench.loop.run_for(_LISTEN_S)
        self._zero.before()
        self._recorder.event(bench.loop.clock.now_s(), "preflight", f"{self._names} answer")
        self._armed = True  # from here on the safe state is owed, whatever happens
        ramp = self._request.bench.dyno.speed_ramp_m_s2 / self._request.bench.vehicle.wheel_radius_m
        bench.rmcu.make_safe()
        self._leave_old_fault()
        bench.dyno.enable(ramp)
        self._watch.active = True
        bench.loop.every(0.05, self._supervise)
        bench.loop.every(_PROGRESS_S, self._show_progress)
        if self._timing:
            bench.loop.every(COLLECT_S, self._timing.collect)
        self._expected_s = estimate_duration_s(self._request.plan)
        self._recorder.event(bench.loop.clock.now_s(), "arm", "drives enabled")

    def _leave_old_fault(self) -> None:
        """A run that was killed leaves the RMCU in fault, with a count of requests that ours do not go on."""
        bench = self._bench
        tries = round(bench.rmcu.safe_within_s / _REPEAT_S)
        while bench.rmcu.state == "fault" and tries:
            bench.loop.wait_for(bench.rmcu.is_safe, _REPEAT_S)
            bench.rmcu.make_safe()
            tries -= 1

    def _note_missing(self) -> None:
        """Devices and parts that this run goes on without."""
        parts = [
            f"{device.name}: {part} is missing"
            for device in self._bench.devices
            if isinstance(device, Incomplete)
            for part in device.missing
        ]
        self._missing = (*(f"{name} is missing: {why}" for name, why in self._bench.missing.items()), *parts)
        for text in self._missing:
            self._recorder.event(self._bench.loop.clock.now_s(), "missing", text)

    def _identify(self) -> None:
        """Listen, and ask the devices meanwhile what they are: asking makes no run longer."""
        bench, tables = self._bench, self._request.bench.device_tables
        bench.loop.run_for(_LISTEN_S / 2)
        found = [identities_of(key, tables[key], device) for key, device in bench.devices_by_key.items()]
        self._identities = tuple(identity for several in found for identity in several)
        bench.loop.wait_for(
            lambda: bench.loop.clock.now_s() > self._begin_s + _LISTEN_S - 0.5 * TICK_S, _LISTEN_S
        )
        said = {f"{i.device}: {i.name}": i.value for i in self._identities if i.value}
        self._recorder.writer.describe("identification", said)

    def _look_at_drift(self) -> None:
        """The drives are off; what comes from here on is no part of the run's rows."""
        try:
            self._zero.after(
                self._bench.loop, ended_well=not self._unsafe and not isinstance(self._error, BenchError)
            )
        except HilError as error:
            self._fail(error)
        except Exception as error:  # the recording is to be closed with what was measured
            self._fail_by(error)

    def _steps(self) -> None:
        plan, conductor = self._request.plan, self._conductor
        try:
            for step in plan.steps:
                step.carry_out(conductor)
        except (InterruptError, BadInputError) as error:
            # The bench is well: torque off, then the plan's own end steps, undisturbed.
            self._fail(error)
            self._bench.loop.shielded = True
            self._bench.rmcu.make_safe()
        for step in plan.finally_:
            step.carry_out(conductor)

    def _supervise(self) -> None:
        if self._watch.standing_still(self._bench.loop.clock.now_s()):
            return  # what came meanwhile is to be looked at first
        for device in self._bench.devices:
            troubles = device.troubles()
            if troubles and not self._bench.loop.shielded:
                raise BenchError("; ".join(troubles), where=device.name, fix=f"look at: {device.name}")

    def _take_samples(self) -> None:
        """Whoever measured: all is recorded, all is watched."""
        now_s = self._bench.loop.clock.now_s()
        for source in self._bench.sources:
            for samples in source.samples():
                self._zero.take(samples)
                if not self._rows_finished:
                    self._recorder.take(samples)
                self._watch.take(samples, now_s)
            self._bench.loop.keep_up()
        pauses = self._watch.pauses.count
        try:
            self._watch.look_for_silence(now_s)
        finally:
            if self._watch.pauses.count > pauses:
                self._try_event("pause", f"own loop stood still for {self._watch.pauses.last_s:.2g} s")

    def _note_fault(self, error: Exception) -> None:
        """A fault of ours, or of a device's code: where it happened stands in the recording."""
        self._try_event("traceback", "".join(traceback.format_exception(error)))

    def _fail_by(self, error: Exception) -> None:
        self._note_fault(error)
        self._fail(BenchError(f"internal error: {type(error).__name__}: {error}", fix="please report it"))

    def _show_progress(self) -> None:
        passed_s = self._bench.loop.clock.now_s() - self._begin_s
        segments = self._conductor.segments
        text = segments[-1].id if segments else "coming up"
        self._request.progress(min(1.0, passed_s / max(self._expected_s, 1e-9)), text)

    def _fail(self, error: HilError) -> None:
        if self._error is None:
            if isinstance(error, BenchError) and "own loop" not in error.what:
                pause = self._watch.pauses.blamed_at(self._bench.loop.clock.now_s())
                if pause:
                    error = BenchError(f"{error.what} ({pause})", where=error.where, fix=error.fix)
            self._error = error
            kind = "interrupt" if isinstance(error, InterruptError) else "failure"
            self._try_event(kind, str(error).replace("\n", " "))

    def _try_event(self, kind: str, text: str) -> None:
        with contextlib.suppress(HilError):  # a full disk is already being reported
            self._recorder.event(self._bench.loop.clock.now_s(), kind, text)

    def _finish(self, wall_s: float) -> RunOutcome:
        request, loop = self._request, self._bench.loop
        safe: SafeState = "not_needed"
        if self._armed:
            safe = "not_confirmed" if self._unsafe else "confirmed"
            self._try_event("safe_state", "; ".join(self._unsafe) or f"confirmed by {self._names}")
        if self._unsafe and not isinstance(self._error, BenchError):
            self._error = BenchError(
                "; ".join(self._unsafe), where="safe state", fix="cut the drives' power before you go near"
            )
        for wire in loop.wires:
            for remark in wire.remarks:
                self._try_event("bus", f"{wire.name}: {remark}")
        bench_time_s = loop.clock.now_s() - self._begin_s
        recording = self._recording()
        self._rows_finished = True
        self._look_at_drift()
        criteria = self._judged(recording) if recording is not None else ()
        result = RunResult(
            verdict=verdict_of(criteria, stopped=self._error is not None),
            plan=request.plan.name,
            bench=request.bench.name,
            real_time_factor=round(bench_time_s / max(wall_s, 1e-9), 2),
            bench_time_s=round(bench_time_s, 3),
            safe_state=safe,
            criteria=criteria,
            segments=tuple(self._conductor.segments),
            clocks=self._recorder.clocks(),
            timing=self._timed(),
            identities=self._identities,
            zeros=self._zero.zeros,
            missing=self._missing,
            reason=str(self._error) if self._error else "",
        )
        try:
            self._store(result)
        except HilError as error:
            self._error = self._error or error
        largest = dict(self._watch.largest)
        return RunOutcome(result, request.out / RECORDING, self._error, largest, tuple(self._conductor.made))

    def _timed(self) -> Timing:
        """How well the loop kept time; what is left of it is recorded."""
        if self._timing is None:
            return Timing(clock="virtual")
        with contextlib.suppress(HilError):  # a full disk is already being reported
            self._timing.collect(everything=True)
        pauses = self._watch.pauses
        return Timing(
            clock="wall",
            requests=self._timing.results(),
            pauses=pauses.count,
            longest_pause_s=round(pauses.longest_s, 3),
        )

    def _judged(self, recording: Recording) -> tuple[CriterionResult, ...]:
        try:
            return judge(self._request.plan, recording, self._conductor.segments)
        except HilError as error:
            self._fail(error)
        except Exception as error:  # the recording is to be closed with what was measured
            self._fail_by(error)
        return ()

    def _recording(self) -> Recording | None:
        try:
            return self._recorder.finish_rows()
        except HilError as error:
            self._fail(error)
            return None

    def _store(self, result: RunResult) -> None:
        writer = self._recorder.writer
        attachments = {"run.json": result.model_dump_json(indent=1).encode()}
        attachments |= {f"made/{name}": content for name, content in self._conductor.made.items()}
        for name, content in attachments.items():
            writer.attach(name, content)
        controllers = {
            f"controller/{name}.toml": text.encode() for name, text in self._conductor.controllers.items()
        }
        writer.describe("time", self._recorder.time_base())
        writer.describe("hashes", hashes(self._inputs() | controllers | attachments))
        writer.close()

    def _inputs(self) -> dict[str, bytes]:
        request = self._request
        inputs = {"plan.yaml": request.plan.text.encode(), "bench.toml": request.bench.text.encode()}
        if self._bench.model is not None:
            inputs["model.toml"] = model_to_toml(self._bench.model).encode()
        return inputs

    def _store_inputs(self) -> None:
        """What is known at the start stands at the start: also a recording that is cut off has it."""
        request, writer = self._request, self._recorder.writer
        for name, content in self._inputs().items():
            writer.attach(name, content)
        operator = request.operator or request.bench.operator
        writer.describe(
            "run",
            {
                "plan": request.plan.name,
                "title": request.plan.title,
                "bench": request.bench.title or request.bench.name,
                "operator": operator,
                "started_at": self._started_at.isoformat(timespec="seconds"),
                "simulated": str(self._bench.simulated).lower(),
                **({"prompts_confirmed_by": request.confirmed_by} if request.confirmed_by else {}),
            },
        )
        writer.describe("dut", request.bench.dut)
        writer.describe("versions", versions())
        dates = {name: date.isoformat() for name, date in request.bench.calibration.items()}
        writer.describe("calibration", dates)
