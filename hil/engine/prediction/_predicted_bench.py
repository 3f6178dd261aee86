"""A bench that is predicted: what the drivers offer, in the ticks that each call takes over CAN.

Here stands how long the wire takes; what the axle does meanwhile is `hil.plant.closed_loop`'s. The numbers
of ticks are those of the drivers: tests hold every prediction against a run, sample by sample.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from drivers import parameters_of
from hil.core.controller import Controller
from hil.core.errors import BadInputError, BenchError
from hil.core.model import Model
from hil.core.vehicle import VehicleAndRoad
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.simulable import rmcu_of
from hil.engine.prediction._predicted_wire import PredictedWire, wire_of
from hil.engine.run.arming import LISTEN_S
from hil.plant import LONGEST_STEP_S
from hil.plant.closed_loop import SIDES, TICK_S, ClosedLoop, Noise
from hil.plant.closed_loop import drive as D
from hil.plant.closed_loop import tick as T
from hil.plant.controller import memory as M
from test_plans import Array, Quantity

LEFT, RIGHT = SIDES
_BLOCK_TICKS = 60_000
_DRAIN_EVERY = 10  # ticks between the looks of a loop that waits for nothing
_SDO_TICKS = 2  # an object is written and read back
_WATCH_OBJECTS = 2  # heartbeat and watch on the host's, each side
_SYNC_OBJECTS = 2
_STATUS_EVERY = 10  # samples after which a drive shows its state
_ACCELERATION_UNIT_RAD_S2 = 1e-4
_MODES: dict[Quantity, int] = {"motor_torque": M.TORQUE, "driving_torque": M.DRIVING_FORCE}
_STATES = ("off", "torque", "driving_force", "fault")


class PredictedLoop:
    """The loop that drivers wait in; what they know is what the last look at the buses brought."""

    def __init__(self, closed: ClosedLoop) -> None:
        self.closed = closed
        self.clock = self
        #: Called after each block of a wait, and after what is played.
        self.after_block: Callable[[], None] = lambda: None
        self._seen = 0  # samples that have been looked at

    def now_s(self) -> float:
        """Bench time in seconds."""
        return self.closed.samples * TICK_S

    @property
    def newest(self) -> Array:
        """The newest sample that the drivers know, as one row."""
        last = max(self._seen, 1) - self.closed.first
        return self.closed.rows[last - 1 : last]

    def run_for(self, duration_s: float, until: Callable[[], bool] = lambda: False) -> bool:  # noqa: ARG002
        """Let time pass; no one holds a prediction."""
        self.run(round(duration_s / TICK_S))
        return True

    def run(self, ticks: int) -> None:
        """Let ticks pass, in blocks: of a long wait nothing need be kept."""
        for first in range(0, ticks, _BLOCK_TICKS):
            self.closed.run(min(_BLOCK_TICKS, ticks - first))
            self.look_on_time()
            self.after_block()

    def transact(self, ticks: int) -> None:
        """Let ticks pass while an answer is awaited: every one is looked at."""
        self.closed.run(ticks)
        self._seen = self.closed.samples

    def look_on_time(self) -> None:
        """Know what a loop knows that looks every ten ticks."""
        self._seen = max(self._seen, self.closed.samples // _DRAIN_EVERY * _DRAIN_EVERY)

    def wait_for(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Tick until `condition` holds; False if it does not within `timeout_s`."""
        for _ in range(max(1, round(timeout_s / TICK_S))):
            if condition():
                return True
            self.transact(1)
        return condition()


class PredictedRmcu:
    """The RMCU behind its driver."""

    fault = "none"

    def __init__(self, loop: PredictedLoop, file: BenchFile, wire: PredictedWire) -> None:
        self._loop, self._dbc, self._known = loop, rmcu_of(file).dbc, wire.parameters

    @property
    def state(self) -> str:
        """The RMCU's last status."""
        return _STATES[int(self._loop.newest[0, T.STATE])]

    def is_safe(self) -> bool:
        """Whether the RMCU says that it gives no torque."""
        torque = self._loop.closed.wire.channel("motor_torque_ref_nm", self._loop.newest)
        return self.state == "off" and float(torque[0]) == 0.0

    def make_safe(self) -> None:
        """Ask for torque off."""
        self._loop.closed.off()

    def play(self, quantity: Quantity, samples_nm: Array) -> None:
        """Request samples, one each tick."""
        self._loop.closed.play(_MODES[quantity], samples_nm)
        self._loop.look_on_time()

    def write_controller(self, controller: Controller) -> None:
        """Write every parameter, then apply: a tick each.

        Raises:
            BadInputError: the DBC has no number for a parameter.
            BenchError: the RMCU would refuse it.
        """
        parameters = parameters_of(controller)
        for name in parameters:
            if name not in self._known:
                raise BadInputError(
                    f"signal 'Index' of 'RMCU_ParameterWrite' has no parameter named '{name}' (VAL_)",
                    where=str(self._dbc),
                    fix="use a DBC that fits this controller",
                )
        self._loop.transact(len(parameters))
        self._loop.closed.set_controller(parameters)
        self._loop.transact(1)


class PredictedDyno:
    """Both dynamometers behind their driver."""

    def __init__(self, loop: PredictedLoop, file: BenchFile, wire: PredictedWire) -> None:
        self._loop, self._file, self._dictionary = loop, file, wire.dictionary

    @property
    def wheel_speed_rad_s(self) -> float:
        """Mean of both wheels, newest value."""
        return float(0.5 * sum(self._wheel_speeds_rad_s()))

    def come_up(self) -> None:
        """Supervision, vehicle model, SYNC, operation: the objects that are written, and their time."""
        v, closed = self._file.vehicle, self._loop.closed
        lines = [v.inertia_kg_m2, v.rolling_nm, v.aero_nms2_rad2]
        known = zip(lines, closed.plant.vehicle, (1, 2, 3), strict=True)
        values = [self._stored(own if own is not None else model, sub) for own, model, sub in known]
        closed.plant.set_vehicle(
            inertia_kg_m2=values[0],
            rolling_nm=values[1],
            aero_nms2_rad2=values[2],
            slip=self._stored(v.slip, 4),
            wheel_radius_m=self._stored(v.wheel_radius_m, 5),
        )
        written = _WATCH_OBJECTS + sum(value is not None for value in (*lines, v.slip, v.wheel_radius_m))
        self._loop.transact(_SDO_TICKS * (len(SIDES) * written + _SYNC_OBJECTS))
        self._loop.transact(1)  # the first values after NMT's 'operational'

    def enable(self, acceleration_rad_s2: float) -> None:
        """Both drives from 'switch on disabled' to holding their present speed."""
        count = round(acceleration_rad_s2 / _ACCELERATION_UNIT_RAD_S2)
        closed = self._loop.closed
        closed.set_ramp(count * self._dictionary[0x6083].factor)
        for side in SIDES:
            self._loop.transact(2 * _SDO_TICKS)  # acceleration and mode
            closed.target_speed(side, self._wheel_speeds_rad_s()[side])
        for _ in ("shutdown", "switch on"):
            self._see_status()
        for side in SIDES:
            closed.drive_mode(side, D.SPEED)
        self._see_status()

    def hold_speed(self, speed_rad_s: float) -> None:
        """Ramp both wheels to a speed; returns when both drives have been reported."""
        closed = self._loop.closed
        for side in SIDES:
            closed.drive_mode(side, D.SPEED)
            self._loop.transact(_SDO_TICKS)
            closed.target_speed(side, speed_rad_s)

    def set_slip(self, slip: float) -> None:
        """Write the slip to both drives."""
        self._loop.closed.plant.set_vehicle(slip=self._stored(slip, 4))
        self._loop.transact(_SDO_TICKS * len(SIDES))

    def set_vehicle(self, vehicle: VehicleAndRoad) -> None:
        """Set mass, road load, slip and friction.

        Raises:
            BenchError: a friction of tyres that hold whatever the road is.
        """
        plant = self._loop.closed.plant
        if (vehicle.friction_left, vehicle.friction_right) != (None, None) and not plant.has_friction:
            raise BenchError(
                "the panel refuses a friction: the tyres of this model hold whatever the road is",
                where="set_vehicle",
                fix='add [[effects]] id = "tyre_friction" to the model of the bench',
            )
        plant.set_vehicle(**vehicle.at_wheels(self._file.vehicle.wheel_radius_m))

    def release_vehicle(self, initial_speed_m_s: float) -> None:
        """Simulate the vehicle from now on."""
        closed = self._loop.closed
        closed.plant.set_vehicle(initial_speed_m_s=self._stored(initial_speed_m_s, 6))
        self._loop.transact(_SDO_TICKS)
        for side in SIDES:
            closed.drive_mode(side, D.VEHICLE)
            self._loop.transact(_SDO_TICKS)

    def make_safe(self) -> None:
        """Both drives without torque, and until they say so."""
        for side in SIDES:
            self._loop.closed.drive_mode(side, D.FREE)
        self._see_status()

    def _see_status(self) -> None:
        """A command takes effect with the next sample and shows with the next status."""
        self._loop.transact(-self._loop.closed.samples % _STATUS_EVERY + 1)

    def _wheel_speeds_rad_s(self) -> tuple[float, float]:
        wire, row = self._loop.closed.wire, self._loop.newest
        left, right = (wire.channel(f"wheel_speed_{side}_rad_s", row)[0] for side in ("left", "right"))
        return float(left), float(right)

    def _stored(self, value: float, subindex: int) -> float:
        """A value of the vehicle model as the drives' objects keep it."""
        variable: Any = self._dictionary[0x2000][subindex]
        return float(variable.decode_raw(variable.encode_raw(value)))


class PredictedBench:
    """A bench with its devices, armed and at rest; `began` is the first sample of its recording."""

    simulated = True

    def __init__(
        self,
        file: BenchFile,
        model: Model,
        noise: Noise | None = None,
        longest_step_s: float = LONGEST_STEP_S,
        wire: PredictedWire | None = None,
    ) -> None:
        self.file, self.model = file, model
        self.wire = wire or wire_of(file)
        held = file.simulation.rmcu if file.simulation else {}
        radius_m = file.vehicle.wheel_radius_m
        closed = ClosedLoop(model, radius_m, self.wire.rounding, held, noise, longest_step_s)
        self.loop = PredictedLoop(closed)
        self.rmcu = PredictedRmcu(self.loop, file, self.wire)
        self.dyno = PredictedDyno(self.loop, file, self.wire)
        self.loop.run_for(LISTEN_S)
        self.dyno.come_up()
        self.began = closed.samples
        self._peaks = dict.fromkeys(self.wire.rounding.channels, 0.0)
        self.loop.run_for(LISTEN_S)
        self.rmcu.make_safe()
        self.dyno.enable(file.dyno.speed_ramp_m_s2 / file.vehicle.wheel_radius_m)

    def peaks(self) -> dict[str, float]:
        """Largest magnitude of each measured channel since the bench was switched on, in its unit."""
        return self._with_peaks_of(self.loop.closed.rows)

    def forget(self, before: int) -> None:
        """Drop the samples before this one; what their peaks are is kept."""
        closed = self.loop.closed
        self._peaks = self._with_peaks_of(closed.rows[: max(0, before - closed.first)])
        closed.forget(before)

    def _with_peaks_of(self, rows: Array) -> dict[str, float]:
        channel = self.loop.closed.wire.channel
        return {
            name: max(peak, float(np.max(np.abs(channel(name, rows)), initial=0.0)))
            for name, peak in self._peaks.items()
        }
