"""The RMCU on its bus: request supervision, parameter service, status frames. Written against the DBC."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from hil.core.can.dbc import Dbc, Needed
from hil.core.channels import TICK_S
from hil.plant.controller import memory as M
from hil.plant.controller import parameters
from sim_backend.rmcu import _requests as R

_READ, _WRITE, _APPLY = range(3)

_IDENTIFY_EVERY_S = 0.1
#: What the emulated firmware says that it is; signals that the DBC has not are left out.
IDENTITY = {
    "SoftwareMajor": 1,
    "SoftwareMinor": 0,
    "SoftwarePatch": 0,
    "HardwareRevision": 1,
    "CalibrationId": 0x0DA2024A,
}
IDENTIFICATION = tuple(IDENTITY)

# What the emulated RMCU and the dyno controller on its bus put into frames or take from them.
NEEDED = {
    "RMCU_Request": Needed(
        ("Counter", "Mode", "TorqueRequest", "Crc"),
        whole=("Counter", "Mode", "Crc"),
        checksum="Crc",
        units={"TorqueRequest": "N m"},
    ),
    "RMCU_Status": Needed(
        ("MotorSpeed", "MotorTorqueRef", "MotorTorque"),
        whole=("Counter", "Crc"),
        optional=("Counter", "Crc"),
        units={"MotorSpeed": "rad/s", "MotorTorqueRef": "N m", "MotorTorque": "N m"},
    ),
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
        units={"DrivingTorqueRef": "N m", "DrivingTorqueEst": "N m"},
    ),
    "RMCU_Identification": Needed((), whole=IDENTIFICATION, optional=IDENTIFICATION, may_miss=True),
    "RMCU_ParameterWrite": Needed(("Command", "Index", "Value"), whole=("Command", "Index")),
    "RMCU_ParameterReply": Needed(
        ("Command", "Result", "Index", "Value"), whole=("Command", "Result", "Index")
    ),
    "RCS_Vehicle": Needed(
        ("VehicleSpeed", "Counter", "Valid", "Crc"),
        whole=("Counter", "Valid", "Crc"),
        checksum="Crc",
        units={"VehicleSpeed": "m/s"},
    ),
}


class RmcuNode:
    """Receives frames and decides on the mode; the control law runs compiled.

    `status` and `control` are the layouts of the frames that show the outcome. Parameters in `held` are used
    in place of those written.
    """

    def __init__(
        self, dbc: Dbc, send: Callable[[int, bytes], None], held: Mapping[str, float] | None = None
    ) -> None:
        self._held = dict(held or {})
        self.memory = M.Memory()
        self._send = send
        self._request = dbc.layouts["RMCU_Request"]
        signals = self._request.signals
        torque = signals["TorqueRequest"]
        places = [signals[name].place for name in ("Crc", "Counter", "Mode")]
        self._reading = (
            self._request.id,
            np.array([*places, torque.place], np.int64),
            torque.scale,
            torque.offset,
        )
        self._whole = np.array([M.OFF, R.NONE, 0, -1], np.int64)
        self._real = np.array([0.0, -1.0, -1.0])
        self._write = dbc.layouts["RMCU_ParameterWrite"]
        self._reply = dbc.layouts["RMCU_ParameterReply"]
        self.status = dbc.layouts["RMCU_Status"]
        self.control = dbc.layouts["RMCU_Control"]
        names = dbc.texts.get(("RMCU_ParameterWrite", "Index"), {})
        self._names = {index: name for name, index in names.items() if index > 0}
        self._stored: dict[str, float] = {}
        self._identification = dbc.layouts.get("RMCU_Identification")
        self._identify_s = 0.0

    @property
    def mode(self) -> int:
        """Mode of the control law in the next sample."""
        return int(self._whole[R.MODE])

    @property
    def request(self) -> float:
        """Torque that the control law is asked for in the next sample, N m."""
        return float(self._real[R.REQUEST])

    @property
    def code(self) -> int:
        """State, request fault and parameter validity in one number: state | fault << 4 | valid << 8."""
        return int(self._whole[R.MODE] | self._whole[R.CAUSE] << 4 | self._whole[R.VALID] << 8)

    @property
    def identifiers(self) -> tuple[int, ...]:
        """Frames that this node listens to."""
        return (self._request.id, self._write.id)

    def receive(self, frame_id: int, payload: int, time_s: float) -> None:
        """Take one frame from the bus."""
        if frame_id == self._request.id:
            R.take_request(np.uint64(payload), time_s, *self._reading, self._whole, self._real)
        elif frame_id == self._write.id:
            self._serve(payload)

    def pass_time(self, time_s: float) -> None:
        """Say which software and calibration this is, when it is time to."""
        layout = self._identification
        if layout is None or time_s < self._identify_s:
            return
        self._identify_s = time_s + _IDENTIFY_EVERY_S
        known = {name: float(IDENTITY[name]) for name in IDENTITY if name in layout.signals}
        payload = int(layout.encode(**known)[0])
        self._send(layout.id, payload.to_bytes(8, "little")[: layout.length])

    def supervise(self, time_s: float) -> None:
        """Drop to fault, torque zero, when what the mode needs has become old."""
        R.supervise(time_s, self._whole, self._real)

    def follow(
        self,
        first: int,
        samples: npt.NDArray[np.int64],
        payloads: npt.NDArray[np.uint64],
        modes: npt.NDArray[np.int64],
        requests: npt.NDArray[np.float64],
        codes: npt.NDArray[np.int64],
    ) -> None:
        """Fill in mode, torque request (N m) and code of sample `first` and those that follow it.

        `payloads`: request frames that come meanwhile, each with the sample before which it comes.
        """
        R.follow(
            first, TICK_S, samples, payloads, *self._reading, self._whole, self._real, modes, requests, codes
        )

    def lose_power(self) -> None:
        """Off, without a torque request."""
        self._whole[R.MODE], self._real[R.REQUEST] = M.OFF, 0.0

    def reset(self) -> None:
        """Boot again: off, without parameters, and no request has ever come."""
        self._whole[:] = M.OFF, R.NONE, 0, -1
        self._real[:] = 0.0, -1.0, -1.0
        self._stored.clear()

    def vehicle_speed_is_fresh(self, time_s: float) -> None:
        """The dyno controller's cyclic vehicle speed arrived at `time_s`."""
        self._real[R.VEHICLE_S] = time_s

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
        self._whole[R.VALID] = 0
        return parameters.OK

    def _apply(self) -> int:
        if self.mode != M.OFF:
            return parameters.NOT_OFF
        result = parameters.build(self._stored | self._held, self.memory)
        if result == parameters.OK:  # what is optional counts for one apply: the next controller may lack it
            for name in parameters.OPTIONAL:
                self._stored.pop(name, None)
        self._whole[R.VALID] = result == parameters.OK
        return result
