"""The RMCU on its bus: request supervision, parameter service, status frames. Written against the DBC."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from hil.core.checksum import crc8
from hil.core.dbc import Dbc, Needed
from hil.plant.controller import memory as M
from hil.plant.controller import parameters

REQUEST_TIMEOUT_S = 0.05
_COUNTER_VALUES = 16
_NONE, _TIMEOUT, _COUNTER, _CRC, _VEHICLE_SPEED, _PARAMETERS = range(6)
_READ, _WRITE, _APPLY = range(3)

# What the emulated RMCU and the dyno controller on its bus put into frames or take from them.
NEEDED = {
    "RMCU_Request": Needed(
        ("Counter", "Mode", "TorqueRequest", "Crc"), whole=("Counter", "Mode", "Crc"), checksum="Crc"
    ),
    "RMCU_Status": Needed(("MotorSpeed", "MotorTorqueRef", "MotorTorque")),
    "RMCU_Control": Needed(
        (
            "DrivingTorqueRef",
            "DrivingTorqueEst",
            "State",
            "RequestFault",
            "Saturated",
            "ParametersValid",
            "Counter",
            "Crc",
        ),
        whole=("State", "RequestFault", "Saturated", "ParametersValid", "Counter", "Crc"),
        checksum="Crc",
    ),
    "RMCU_ParameterWrite": Needed(("Command", "Index", "Value"), whole=("Command", "Index")),
    "RMCU_ParameterReply": Needed(
        ("Command", "Result", "Index", "Value"), whole=("Command", "Result", "Index")
    ),
    "RCS_Vehicle": Needed(
        ("VehicleSpeed", "Counter", "Valid", "Crc"), whole=("Counter", "Valid", "Crc"), checksum="Crc"
    ),
}


class RmcuNode:
    """Receives frames and decides on the mode; the control law runs compiled.

    `mode` and `request` are what the control law uses in the next sample; `status` and `control` are the
    layouts of the frames that show the outcome. Parameters in `held` are used in place of those written.
    """

    def __init__(
        self, dbc: Dbc, send: Callable[[int, bytes], None], held: Mapping[str, float] | None = None
    ) -> None:
        self._held = dict(held or {})
        self.memory = M.Memory()
        self.mode = M.OFF
        self.request = 0.0
        self._send = send
        self._request = dbc.layouts["RMCU_Request"]
        signals = self._request.signals
        self._read = signals["Crc"], signals["Counter"], signals["Mode"], signals["TorqueRequest"]
        self._write = dbc.layouts["RMCU_ParameterWrite"]
        self._reply = dbc.layouts["RMCU_ParameterReply"]
        self.status = dbc.layouts["RMCU_Status"]
        self.control = dbc.layouts["RMCU_Control"]
        names = dbc.texts.get(("RMCU_ParameterWrite", "Index"), {})
        self._names = {index: name for name, index in names.items() if index > 0}
        self._stored: dict[str, float] = {}
        self._valid = False
        self._fault = _NONE
        self._counter: int | None = None
        self._last_request_s = -1.0
        self._last_vehicle_s = -1.0

    @property
    def identifiers(self) -> tuple[int, ...]:
        """Frames that this node listens to."""
        return (self._request.id, self._write.id)

    def receive(self, frame_id: int, payload: int, time_s: float) -> None:
        """Take one frame from the bus."""
        if frame_id == self._request.id:
            self._take_request(payload, time_s)
        elif frame_id == self._write.id:
            self._serve(payload)

    def supervise(self, time_s: float) -> None:
        """Drop to fault, torque zero, when what the mode needs has become old."""
        if self.mode in (M.OFF, M.FAULT):
            return
        if time_s - self._last_request_s > REQUEST_TIMEOUT_S:
            self._fail(_TIMEOUT)
        elif self.mode == M.DRIVING_FORCE and time_s - self._last_vehicle_s > REQUEST_TIMEOUT_S:
            self._fail(_VEHICLE_SPEED)

    @property
    def code(self) -> int:
        """State, request fault and parameter validity in one number: state | fault << 4 | valid << 8."""
        return self.mode | self._fault << 4 | int(self._valid) << 8

    def _take_request(self, payload: int, time_s: float) -> None:
        crc, count, mode, request = self._read
        if crc.raw(payload) != crc8(self._request.id, payload):
            self._fault = _CRC if self._fault == _NONE else self._fault
            return
        counter = count.raw(payload)
        expected = None if self._counter is None else (self._counter + 1) % _COUNTER_VALUES
        self._counter = counter
        if expected is not None and counter != expected:
            self._fault = _COUNTER if self._fault == _NONE else self._fault
            return
        self._last_request_s = time_s
        self._change_mode(mode.raw(payload), time_s)
        self.request = request.value(payload) if self.mode in (1, 2) else 0.0

    def _change_mode(self, wanted: int, time_s: float) -> None:
        if wanted == M.OFF:
            self.mode, self._fault = M.OFF, _NONE
        elif self.mode == M.FAULT or wanted > M.DRIVING_FORCE:
            return  # a fault stays until the bench has asked for 'off'
        elif wanted == M.DRIVING_FORCE and not self._valid:
            self._fail(_PARAMETERS)
        elif wanted == M.DRIVING_FORCE and time_s - self._last_vehicle_s > REQUEST_TIMEOUT_S:
            self._fail(_VEHICLE_SPEED)
        else:
            self.mode = wanted
            if self._fault in (_CRC, _COUNTER):
                self._fault = _NONE

    def _fail(self, fault: int) -> None:
        self.mode, self.request, self._fault = M.FAULT, 0.0, fault

    def vehicle_speed_is_fresh(self, time_s: float) -> None:
        """The dyno controller's cyclic vehicle speed arrived at `time_s`."""
        self._last_vehicle_s = time_s

    def _serve(self, payload: int) -> None:
        signals = self._write.signals
        command, index = signals["Command"].raw(payload), signals["Index"].raw(payload)
        value = signals["Value"].value(payload)
        name = self._names.get(index)
        result = parameters.OK
        if command == _APPLY:
            result = self._apply()
        elif name is None:
            result = parameters.UNKNOWN_INDEX
        elif command == _WRITE:
            result = self._store(name, value)
        answer = self._stored.get(name, float("nan")) if name else float(result)
        reply = self._reply.encode(Command=command, Result=result, Index=index, Value=answer)
        self._send(self._reply.id, int(reply[0]).to_bytes(8, "little")[: self._reply.length])

    def _store(self, name: str, value: float) -> int:
        if self.mode != M.OFF:
            return parameters.NOT_OFF
        if not parameters.in_range(name, value):
            return parameters.OUT_OF_RANGE
        self._stored[name] = value
        self._valid = False
        return parameters.OK

    def _apply(self) -> int:
        if self.mode != M.OFF:
            return parameters.NOT_OFF
        result = parameters.build(self._stored | self._held, self.memory)
        self._valid = result == parameters.OK
        return result
