"""The simulated bench: virtual time, two buses, the RMCU and four dynamometers around one plant."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc import read_dbc
from hil.core.can.frames import FrameBlock, longest_frame_s
from hil.core.channels import TICK_S
from hil.core.errors import BadInputError
from hil.plant.closed_loop import Noise, advance, state_at_rest
from hil.plant.closed_loop import drive as drive
from hil.plant.closed_loop import tick as T
from hil.plant.controller import memory as memory
from sim_backend.bench._outgoing import DYNO_BUS, RAM_BUS, RMCU_BUS, Inbox, Outgoing, Sent
from sim_backend.bench._settings import SENSED_CHANNELS, Fault, SensorFault, SimulationSettings, Tamper
from sim_backend.bench._vehicle_model import preset_vehicle, set_vehicle, show_measured, take_vehicle_model
from sim_backend.rcs import DynoNode
from sim_backend.rmcu import LARGEST_TORQUE_NM, NEEDED, RmcuMemory, RmcuNode, XcpSlave

_NOISE_BLOCK = 1000
_LARGEST_BATCH = 4096
_NODES_EVERY = 10  # samples between looks at heartbeats: no more are computed at once
_NO_SAMPLES, _NO_REQUESTS = np.zeros(0, np.int64), np.zeros(0, np.uint64)
_HEARTBEATS = range(0x701, 0x780)
_EMCY_SHORT_CIRCUIT = 0x2320  # CiA 402: short circuit or earth leakage at the output
_RUNAWAY_RAD_S = 200.0
_BOOT_TICKS = 300


class SimulatedBench:
    """A bench whose time passes only while somebody waits for it. It is also the `Clock` of its users.

    Frames that hosts send are delivered at the next sample; everything that the nodes send is kept until
    `take` is called for its bus. What passes unseen is computed when somebody looks, several samples at once.
    """

    virtual = True

    def __init__(self, settings: SimulationSettings) -> None:
        if settings.model.kind == "transfer_function":
            raise BadInputError(
                "a 'transfer_function' model cannot be a simulated bench: it has no shaft to load",
                fix="give a rigid, two_inertia or three_inertia model",
            )
        self.settings = settings
        self.faults: set[Fault] = set()
        self.tamper: Tamper | None = None
        self._boots_until: int | None = None
        self._diverged = False
        self._samples = 0  # computed so far
        self._due = 0  # samples whose time has come
        self._now_s = 0.0
        self._modes, self._codes = np.zeros(_NODES_EVERY, np.int64), np.zeros(_NODES_EVERY, np.int64)
        self._requests = np.zeros(_NODES_EVERY)
        self._rows = np.zeros((_LARGEST_BATCH, T.COLUMNS))
        self._first_row = 0
        self._last_row = np.zeros(T.COLUMNS)
        self._make_state()
        self._make_nodes()

    # --- the clock ---

    def now_s(self) -> float:
        """Virtual time in seconds."""
        return self._now_s

    def sleep_until(self, time_s: float) -> None:
        """Let virtual time be `time_s`."""
        last = int((time_s + 1e-9) / TICK_S)
        if last > self._due:
            self._due = last
            self._now_s = max(self._now_s, last * TICK_S)
            if (
                last - self._samples > _LARGEST_BATCH or self._samples == 0
            ):  # what is slow the first time is over
                self._compute()
        self._now_s = max(self._now_s, time_s)
        if self.tamper is not None:
            self.tamper.time_passes(self._now_s)

    # --- the devices ---

    @property
    def rmcu(self) -> RmcuNode:
        """The RMCU as it is now."""
        self._compute()
        return self._rmcu

    @property
    def dynos(self) -> list[DynoNode]:
        """The dynamometers' nodes as they are now: rear left, rear right, then idle ones."""
        self._compute()
        return self._dynos

    @property
    def xcp(self) -> XcpSlave | None:
        """What shows the RMCU's memory; None if nothing does."""
        return self._xcp

    @property
    def buses(self) -> tuple[str, ...]:
        """Its buses."""
        ram = self.settings.ram
        return (RMCU_BUS, DYNO_BUS) if ram is None or ram.bus == RMCU_BUS else (RMCU_BUS, DYNO_BUS, ram.bus)

    # --- the wire ---

    def put(self, bus: str, frame_id: int, data: bytes) -> None:
        """A host's frame: it reaches the nodes at the next sample."""
        sent = [(frame_id, data)] if self.tamper is None else self.tamper.to_nodes(bus, frame_id, data)
        for number, content in sent:
            self._inbox.put(self._due, bus, number, content)

    def put_ahead(
        self,
        bus: str,
        frame_id: int,
        payloads: npt.NDArray[np.uint64],
        length: int,
        times_s: npt.NDArray[np.float64],
    ) -> None:
        """A host's frames of one identifier, each at a time that is now or will come, in order."""
        samples = ((times_s + 1e-9) / TICK_S).astype(np.int64).tolist()
        self._inbox.put_all(samples, bus, frame_id, payloads.tolist(), length)

    def take(self, bus: str) -> FrameBlock:
        """All frames that have appeared on `bus` until now and were not taken yet, in order of time."""
        self._compute()
        self._emit()
        block = self._outgoing.taken(bus)
        return block if self.tamper is None else self.tamper.to_hosts(bus, block)

    # --- construction ---

    def _make_state(self) -> None:
        self._plant = state_at_rest(self.settings.model, self.settings.wheel_radius_m)
        self._drives = self._plant.drives
        for row, channel in zip(self._plant.sensors, SENSED_CHANNELS, strict=True):
            fault = self.settings.sensors.get(channel, SensorFault())
            row[T.SENSOR_GAIN] *= fault.gain
            row[T.SENSOR_OFFSET] = row[T.SENSOR_OFFSET] * fault.gain + fault.offset
        self._status = np.zeros(2)
        noise = self.settings.noise
        self._sensor_noise = Noise(
            noise.motor_speed_rad_s, noise.wheel_speed_rad_s, noise.shaft_torque_nm, self.settings.seed
        )
        # behind the noise is the tick's scratch room
        self._noise = np.tile(self._plant.noise, (_NOISE_BLOCK, 1))

    def _make_nodes(self) -> None:
        s = self.settings
        dbc = read_dbc(s.dbc, NEEDED, s.names)
        self._outgoing = Outgoing(s.rmcu_bit_rate, s.dyno_bit_rate, dbc.layouts["RCS_Vehicle"], s.ram)
        self._make_memory()
        self._rmcu = RmcuNode(dbc, lambda i, data: self._event(RMCU_BUS, i, data), s.held)
        request = dbc.layouts["RMCU_Request"]
        self._inbox = Inbox((RMCU_BUS, request.id))
        rows = {s.rear_left: self._drives[0], s.rear_right: self._drives[1]}
        self._dynos = [
            DynoNode(
                node,
                s.eds,
                lambda i, data: self._event(DYNO_BUS, i, data),
                rows.get(node, np.zeros(drive.COLUMNS)),
            )
            for node in (s.rear_left, s.rear_right, *s.idle)
        ]
        preset_vehicle(self._plant, self._dynos, s.wheel_radius_m)
        request_s = longest_frame_s(request.length, s.rmcu_bit_rate)
        self._outgoing.nodes_are(self._rmcu, self._dynos, request_s)
        m = self._rmcu.memory
        m.gains[memory.SAMPLE_TIME] = TICK_S
        m.gains[memory.TORQUE_LIMIT] = LARGEST_TORQUE_NM  # until a controller sets its own
        self._firmware = (m.numerators, m.denominators, m.filter_states, m.gains, m.states)

    def _make_memory(self) -> None:
        self._xcp: XcpSlave | None = None
        ram = self.settings.ram
        if ram is None:
            return
        self._ram_bus, self._command_id = ram.bus, ram.request_id
        self._ram = memory = RmcuMemory(ram)
        self._xcp = XcpSlave(
            memory,
            lambda address, size: memory.read(self._newest_row(), address, size),
            lambda packet: self._event(ram.bus, ram.answer_id, packet),
            ram.order,
        )

    # --- one sample ---

    def _compute(self) -> None:
        """Catch up with the time.

        Raises:
            BadInputError: the simulation diverges.
        """
        while self._samples < self._due:
            first = self._samples
            if self._boots_until is not None and first >= self._boots_until:
                self._has_booted()
            self._deliver(first)
            end = min(
                self._due, first - first % _NODES_EVERY + _NODES_EVERY, self._first_row + _LARGEST_BATCH
            )
            end = self._inbox.next_break(end)
            self._advance(first, end)
            self._samples = end
            error = self._mended(end)
            if end - self._first_row == _LARGEST_BATCH:
                self._emit()
            if error is not None:
                raise error

    def _advance(self, first: int, end: int) -> None:
        """Samples `first` to before `end`; between them nothing but torque requests may come."""
        samples = slice(end - first)
        modes, requests, codes = self._modes[samples], self._requests[samples], self._codes[samples]
        self._rmcu.follow(first, *self._requests_until(end), modes, requests, codes)
        if first % _NODES_EVERY == 0:
            if Fault.RMCU_SILENT not in self.faults:
                self._rmcu.pass_time(first * TICK_S)
            for node in self._dynos:
                node.pass_time(first * TICK_S)
            self._status[0] = self._dynos[0].power.statusword
            self._status[1] = self._dynos[1].power.statusword
        if first % _NOISE_BLOCK == 0:
            self._noise[:, : T.SENSORS] = self._sensor_noise.drawn(_NOISE_BLOCK)
        advance(
            first,
            self._plant.x,
            self._plant.form,
            self._plant.vector,
            self._plant.scalars,
            self._plant.torques,
            self._firmware,
            self._drives,
            self._plant.sensors,
            self._plant.past,
            self._noise[first % _NOISE_BLOCK :],
            modes,
            requests,
            codes,
            self._status,
            self._rows[first - self._first_row :],
        )

    def _mended(self, sample: int) -> BadInputError | None:
        """That the simulation diverges, once; the axle stands then, so that its host can end the run."""
        try:
            self._plant.refuse_diverged(sample * TICK_S)
        except BadInputError as error:
            self._plant.stand_still()
            for kept in (self._rmcu.memory.filter_states, self._rmcu.memory.states):
                kept[:] = 0
            rows = self._rows[: sample - self._first_row]
            np.nan_to_num(rows, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
            first, self._diverged = not self._diverged, True
            return error if first else None
        return None

    def _requests_until(self, end: int) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.uint64]]:
        """The samples before which torque requests come, and these."""
        came = self._inbox.requests_before(end)
        return (_NO_SAMPLES, _NO_REQUESTS) if self._is_deaf(RMCU_BUS) else came

    def _deliver(self, sample: int) -> None:
        """What hosts sent before `sample`."""
        time_s = sample * TICK_S
        for sent in self._inbox.until(sample):
            if self._is_deaf(sent.bus):
                continue
            if self._xcp is not None and (sent.bus, sent.frame_id) == (self._ram_bus, self._command_id):
                self._serve_memory(sent.data, time_s)
            elif sent.bus == RMCU_BUS:
                self._rmcu.receive(sent.frame_id, sent.payload, time_s)
            else:
                self._to_dynos(sent, time_s)

    def _to_dynos(self, sent: Sent, time_s: float) -> None:
        heartbeat = sent.frame_id in _HEARTBEATS  # it changes nothing of what is sent
        if not heartbeat:
            show_measured(self._newest_row(), self._dynos)
            self._emit()  # what the nodes send may change from here on
        data = sent.data
        for node in self._dynos:
            node.receive(sent.frame_id, data, time_s)
        if not heartbeat:
            take_vehicle_model(self._plant, self._dynos[0])
            self._outgoing.dynos_changed()

    def _serve_memory(self, command: bytes, time_s: float) -> None:
        assert self._xcp is not None
        ran = self._xcp.running
        self._emit()  # what is sent may change from here on
        self._xcp.receive(command, time_s)
        if ran != self._xcp.running:
            self._measures()

    def _measures(self) -> None:
        """What the RMCU's memory is looked at for from now on."""
        assert self._xcp is not None
        if not self._outgoing.measures(self._xcp.running, self._ram):
            self._xcp.overloaded()

    def reset_xcp(self) -> None:
        """The slave starts again; no one is connected to it."""
        if self._xcp is not None:
            self._compute()
            self._emit()
            self._xcp.reset()
            self._measures()

    def _newest_row(self) -> npt.NDArray[np.float64]:
        new = self._samples - self._first_row
        return self._rows[new - 1] if new else self._last_row

    def _is_deaf(self, bus: str) -> bool:
        if not self.faults:
            return False
        if bus == RAM_BUS:
            return Fault.RMCU_SILENT in self.faults
        deaf = (Fault.RMCU_SILENT, Fault.RMCU_DEAF) if bus == RMCU_BUS else (Fault.DYNO_DEAF,)
        return any(fault in self.faults for fault in deaf)

    def fail(self, fault: Fault) -> None:
        """Break a device, from now on."""
        self._compute()
        self._emit()
        self.faults.add(fault)
        if fault is Fault.RMCU_SILENT:
            self._rmcu.lose_power()
        if fault is Fault.DYNO_SILENT:
            self._dynos[0].switch_off()
        if fault in (Fault.RMCU_SILENT, Fault.RMCU_RESET):
            self.reset_xcp()
        if fault is Fault.RMCU_RESET:
            self._rmcu.reset()
            self._boots_until = self._samples + _BOOT_TICKS
            self.faults.add(Fault.RMCU_SILENT)
        if fault is Fault.DYNO_RESET:
            self._dynos[0].reset()
        if fault is Fault.DYNO_FAULT:
            self._dynos[0].fail(_EMCY_SHORT_CIRCUIT)
        if fault is Fault.DYNO_RUNAWAY:
            for node in self._dynos[:2]:
                node.run_away(_RUNAWAY_RAD_S)
        self._outgoing.rmcu_talks(Fault.RMCU_SILENT not in self.faults)
        self._outgoing.dynos_changed()

    def _has_booted(self) -> None:
        """The RMCU is there again."""
        self._boots_until = None
        self._emit()
        self.faults -= {Fault.RMCU_SILENT, Fault.RMCU_RESET}
        self._outgoing.rmcu_talks(True)

    def spoil(self, channel: str, fault: SensorFault) -> None:
        """A sensor reads something else from now on."""
        self._compute()
        row = self._plant.sensors[SENSED_CHANNELS.index(channel)]
        row[T.SENSOR_GAIN] *= fault.gain
        row[T.SENSOR_OFFSET] = row[T.SENSOR_OFFSET] * fault.gain + fault.offset

    def set_vehicle(self, values: Mapping[str, float]) -> None:
        """The dyno controller's vehicle model has other values from now on: its panel has set them."""
        self._compute()
        set_vehicle(self._plant, self._dynos, values)

    @property
    def has_friction(self) -> bool:
        """Whether the road's friction bounds what the tyres pass."""
        return self._plant.has_friction

    # --- what is sent ---

    def _event(self, bus: str, frame_id: int, data: bytes) -> None:
        self._outgoing.event(bus, self._samples, frame_id, data)

    def _emit(self) -> None:
        count = self._samples - self._first_row
        if count == 0:
            return
        rows = self._rows[:count]
        self._last_row[:] = rows[-1]
        if self.tamper is not None:
            self.tamper.look(self._first_row, rows)
        self._outgoing.cyclic(rows, self._first_row)
        self._first_row = self._samples
