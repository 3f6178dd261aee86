"""Executes what a plan's steps ask for, tick by tick, on an open bench."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal

import numpy as np

from drivers import TICK_S, SetsSlip, SetsVehicle
from hil.core.controller import Controller, load_controller
from hil.core.errors import BenchError
from hil.core.files import write_atomically
from hil.core.files.toml_file import toml_text
from hil.core.recording import SEGMENT, VEHICLE
from hil.core.result import RunResult, Segment
from hil.core.vehicle import VehicleAndRoad
from hil.engine.bench.bench import Bench
from hil.engine.bench.request_timing import Periodic
from hil.engine.ipc.ipc import Analyse, Analysis, analysed_here
from hil.engine.run.hold import Holding
from hil.engine.run.preflight import Rehearsal
from hil.engine.run.recorder import Recorder
from hil.engine.run.waveform_player import WaveformPlayer
from test_plans import PROMPT_TIMEOUT_S, Array, PlannedSegment, Quantity, Work

_SPEED_TOLERANCE_RAD_S = 0.5
_SPEED_GRACE_S = 5.0
RELEASE_S = 0.2  # torque is taken away over this time after a stretch of samples


def release_from(torque_nm: float) -> Array:
    """Samples, one each tick, that take a torque away; none where there is none."""
    return np.linspace(torque_nm, 0.0, round(RELEASE_S / TICK_S)) if torque_nm else np.zeros(0)


class BenchConductor:
    """The engine's side of `test_plans.Conductor`."""

    sample_time_s = TICK_S

    def __init__(
        self,
        bench: Bench,
        recorder: Recorder,
        out: Path,
        ask: Callable[[str, float, str], str],
        analyse: Analyse = analysed_here,
        noted: Periodic | None = None,
        hold: Holding | None = None,
        wait_for: Callable[[Callable[[], bool], float], bool] | None = None,
    ) -> None:
        self._bench, self._recorder, self._out = bench, recorder, out
        self._ask, self._analyse, self._noted, self._hold = ask, analyse, noted, hold
        self._wait_for = wait_for
        self._check = Rehearsal(bench.file)  # the bench's limits lie below every plan
        self._controller: Controller | None = None
        self._speed_m_s, self._slip = 0.0, bench.file.vehicle.slip
        self._friction: dict[str, float] = {}  # under each tyre, as set
        self._load: Literal["vehicle", "speed"] = "speed"
        self.segments: list[Segment] = []
        self.controllers: dict[str, str] = {}
        self.made: dict[str, bytes] = {}
        self._confirmed: dict[str, str] = {}  # of vehicle and road load

    def set_controller(self, file: Path) -> None:
        """Write a controller to the RMCU (torque off) and read it back."""
        self._check.set_controller(file)
        made = not file.is_absolute() and file.name in self.made
        if made:
            file = self._out / file
        controller = load_controller(file)
        self._bench.rmcu.write_controller(controller)
        self._controller = controller
        if file.stem not in self.controllers:
            text = toml_text(file)
            self.controllers[file.stem] = text
            if not made:
                self._recorder.store_source(f"controller/{file.stem}.toml", file)
            self._recorder.writer.attach(f"controller/{file.stem}.toml", text.encode())
        self._event(
            "controller", f"{controller.name} ({controller.stabilization} stabilization) written, read back"
        )

    def hold_speed(self, speed_m_s: float, duration_s: float) -> None:
        """Ramp to a speed and hold it."""
        self._check.hold_speed(speed_m_s, duration_s)
        self._whole(lambda: self._held_speed(speed_m_s, duration_s), back=False)

    def _held_speed(self, speed_m_s: float, duration_s: float) -> bool:
        radius_m = self._bench.file.vehicle.wheel_radius_m
        if not self._brought_to(speed_m_s / radius_m):
            return False
        self._speed_m_s = speed_m_s
        self._event("speed", f"dynos hold {speed_m_s * 3.6:.1f} km/h")
        return self._bench.loop.run_for(duration_s, self._is_due)

    def _brought_to(self, target_rad_s: float) -> bool:
        """Whether the wheels have got there; false if the run is to be held before."""
        dyno, loop = self._bench.dyno, self._bench.loop
        ramp_s = abs(target_rad_s - dyno.wheel_speed_rad_s) * self._bench.file.vehicle.wheel_radius_m
        ramp_s /= self._bench.file.dyno.speed_ramp_m_s2
        dyno.hold_speed(target_rad_s)
        self._load = "speed"
        if not loop.run_for(ramp_s, self._is_due):
            return False
        reached = loop.wait_for(
            lambda: abs(dyno.wheel_speed_rad_s - target_rad_s) < _SPEED_TOLERANCE_RAD_S, _SPEED_GRACE_S
        )
        if not reached:
            raise BenchError(
                f"the wheels turn at {dyno.wheel_speed_rad_s:.2f} rad/s, "
                f"{target_rad_s:.2f} rad/s was requested",
                where="dynos",
                fix="check the dyno controller's torque limit",
            )
        return True

    def set_slip(self, slip: float) -> None:
        """Write a slip to the dynos' vehicle; read back.

        Raises:
            BenchError: the kind of dyno has none.
        """
        dyno = self._bench.dyno
        if not isinstance(dyno, SetsSlip):
            raise BenchError("does not support wheel slip", where="dyno", fix="remove set_slip from the plan")
        dyno.set_slip(slip)
        self._slip = slip
        self._event("slip", f"the dynos' vehicle slips by {100.0 * slip:g} %")

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """Set vehicle and road load at the first device that takes them; what it confirmed is recorded.

        Raises:
            BenchError: there is none, or it does not take them.
        """
        self._check.set_vehicle(vehicle)
        for name, device in self._bench.further.items():
            if isinstance(device, SetsVehicle):
                self._confirmed |= device.set_vehicle(vehicle)
                self._take_friction(vehicle)
                words = ", ".join(f"{key} {value}" for key, value in self._confirmed.items())
                self._event("vehicle", f"{name} confirms: {words}")
                self._recorder.writer.describe(VEHICLE, self._confirmed)
                return
        raise BenchError(
            "no device accepts vehicle and road load",
            where="set_vehicle",
            fix='give the bench file a panel: [devices.panel] with kind = "rcs-panel"',
        )

    def _take_friction(self, vehicle: VehicleAndRoad) -> None:
        sides = {"left": vehicle.friction_left, "right": vehicle.friction_right}
        self._friction |= {side: friction for side, friction in sides.items() if friction is not None}

    def release_vehicle(self) -> None:
        """Let the dynos simulate the vehicle."""
        self._release(self._speed_m_s)

    def _release(self, speed_m_s: float) -> None:
        self._bench.dyno.release_vehicle(speed_m_s)
        self._load = "vehicle"
        self._event("speed", "dynos simulate the vehicle")

    def play(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> None:
        """Request the samples one each tick, then take the torque away and switch it off."""
        self._check.play(quantity, samples_nm, segment)
        self._whole(lambda: self._played_whole(quantity, samples_nm, segment))

    def _played_whole(self, quantity: Quantity, samples_nm: Array, segment: PlannedSegment | None) -> bool:
        loop = self._bench.loop
        values = np.concatenate([samples_nm, release_from(samples_nm[-1])])
        if segment:
            self._begin(segment, loop.clock.now_s(), len(samples_nm))
        playing = WaveformPlayer(self._bench, self._noted)
        try:
            sent = playing.send(quantity, values, self._is_due)
        finally:
            whole = playing.passed >= len(samples_nm)
            if segment:
                self._end(loop.clock.now_s(), complete=whole)
        if sent < len(values) and values[sent - 1]:
            playing.send(quantity, release_from(values[sent - 1]))
        self._switch_off()
        return whole

    def _is_due(self) -> bool:
        return self._hold is not None and self._hold.due()

    def _whole(self, attempt: Callable[[], bool], *, back: bool = True) -> None:
        """Carry it out; after each hold on the way again from its beginning.

        Args:
            back: whether it begins at the speed and with the load that it found.
        """
        dyno, load = self._bench.dyno, self._load
        began_rad_s = dyno.wheel_speed_rad_s
        while self._is_due() or not attempt():
            assert self._hold is not None
            self._switch_off()
            dyno.hold_speed(dyno.wheel_speed_rad_s)
            self._load = "speed"
            self._hold.wait()
            self._keep_what_was_held()
            radius_m = self._bench.file.vehicle.wheel_radius_m
            target_rad_s = began_rad_s if load == "vehicle" else self._speed_m_s / radius_m
            if back and self._brought_to(target_rad_s) and load == "vehicle":
                self._release(began_rad_s * radius_m)

    def _keep_what_was_held(self) -> None:
        """A segment that was cut off by a hold gets a name of its own: it is started again under its own."""
        if self.segments and not self.segments[-1].complete:
            started = self.segments[-1]
            count = sum(segment.id.startswith(f"{started.id}_held_") for segment in self.segments)
            self.segments[-1] = started.model_copy(update={"id": f"{started.id}_held_{count + 1}"})
            self._store_segment()

    def coast(self, duration_s: float) -> None:
        """No motor torque for a while."""
        self._switch_off()
        self.wait(duration_s)

    def wait(self, duration_s: float) -> None:
        """Let time pass."""
        self._whole(lambda: self._bench.loop.run_for(duration_s, self._is_due))

    def prompt(self, text: str, timeout_s: float = PROMPT_TIMEOUT_S, picture: str = "") -> None:
        """Ask the operator, with the RMCU off; the dynos hold."""
        self._switch_off()
        self._event("prompt", text)
        self._event("prompt", self._ask(text, timeout_s, picture))

    def ramp_down(self, duration_s: float) -> None:
        """Torque off, then the dynos bring the wheels to standstill."""
        self._switch_off()
        self.hold_speed(0.0, duration_s)

    def analyse(self, name: str, work: Work, makes: tuple[str, ...]) -> None:
        """Analyse the run so far; on a bench with hardware heartbeats go on meanwhile."""
        self._check.analyse(name, work, makes)
        self._switch_off()
        recording = self._recorder.so_far()
        recording.attachments["run.json"] = self._result_so_far().model_dump_json().encode()
        files = self._awaited(self._analyse(work, recording, self._out))
        for file, content in files.items():
            write_atomically(self._out / file, content)
            self.made[file] = content
        self._event("analysis", f"{name}: {', '.join(sorted(files))}")

    def _result_so_far(self) -> RunResult:
        return RunResult(
            verdict="error",
            plan="",
            bench=self._bench.file.name,
            real_time_factor=0.0,
            bench_time_s=0.0,
            safe_state="not_needed",
            segments=tuple(self.segments),
            reason="the run is still active",
        )

    def _awaited(self, analysis: Analysis) -> Mapping[str, bytes]:
        """What it gives; heartbeats go on meanwhile, and whatever ends the run ends it."""
        try:
            if not analysis.done() and self._wait_for is not None:
                self._wait_for(analysis.done, math.inf)
            return analysis.result()
        except BaseException:
            analysis.kill()
            raise

    def _begin(self, planned: PlannedSegment, clock_s: float, samples: int) -> None:
        start_s = self._recorder.recording_time(clock_s)
        end_s = start_s + min(planned.end_s, samples * TICK_S)
        controller = self._controller
        driven = controller if planned.quantity == "driving_torque" else None
        vehicle = self._bench.file.vehicle
        self.segments.append(
            Segment(
                id=planned.id,
                kind=planned.kind,
                start_s=start_s,
                step_s=round(start_s + planned.step_s, 6),
                end_s=round(end_s, 6),
                first_change_s=(
                    None if planned.first_change_s is None else round(start_s + planned.first_change_s, 6)
                ),
                complete=False,
                controller=driven.stabilization if driven else "",
                controller_name=driven.name if driven else "",
                load=self._load,
                initial_speed_km_h=round(self._speed_m_s * 3.6, 6),
                reference_before=planned.reference_before,
                reference_after=planned.reference_after,
                quantity=planned.quantity,
                torque_limit_nm=driven.torque_limit_nm if driven else None,
                gear_ratio=self._gear_ratio(),
                wheel_orders=tuple(vehicle.wheel_orders),
                rolling_radius_m=vehicle.wheel_radius_m * (1.0 - self._slip),
                friction=min(self._friction.values(), default=None),
            )
        )
        self._store_segment()
        self._event("segment", f"{planned.id} begins")

    def _gear_ratio(self) -> float | None:
        """Of the bench file, else of the controller, else of the channel that the bench computes with it."""
        known = self._bench.file
        if known.vehicle.gear_ratio is not None:
            return known.vehicle.gear_ratio
        if self._controller is not None:
            return self._controller.dfo.gear_ratio
        return known.limits.twist.gear_ratio if known.limits.twist else None

    def _end(self, clock_s: float, *, complete: bool) -> None:
        """A segment ends where it was stopped, and only one that was executed whole can be judged."""
        started = self.segments[-1]
        end_s = started.end_s if complete else min(started.end_s, self._recorder.recording_time(clock_s))
        self.segments[-1] = started.model_copy(update={"end_s": end_s, "complete": complete})
        with contextlib.suppress(BenchError):  # a full disk is already being reported
            self._store_segment()
            self._event("segment", f"{started.id} {'ends' if complete else 'was stopped'}")

    def _store_segment(self) -> None:
        segment = self.segments[-1]
        self._recorder.writer.describe(SEGMENT + segment.id, {"json": segment.model_dump_json()})

    def _switch_off(self) -> None:
        rmcu, loop = self._bench.rmcu, self._bench.loop
        rmcu.make_safe()
        if not loop.wait_for(rmcu.is_safe, 0.1):
            rmcu.make_safe()  # one lost frame must not end a run
            if not loop.wait_for(rmcu.is_safe, 0.1):
                raise BenchError(f"the RMCU did not switch off (state {rmcu.state})", where="RMCU")

    def _event(self, kind: str, text: str) -> None:
        self._recorder.event(self._bench.loop.clock.now_s(), kind, text)
