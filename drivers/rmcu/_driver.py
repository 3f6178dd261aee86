"""Talks to the Rear Motor Control Unit; every frame and every name comes from the DBC."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from drivers.device import Examined, Finding
from drivers.echoes import NewestFrames
from drivers.frame_source import Binding, CountedBy, FrameSource
from drivers.loop import BusLoop
from drivers.rmcu._damage import FrameDamage, has_checksum
from drivers.rmcu._parameters import parameters_of
from drivers.wire import Wire
from hil.core.can.dbc import Dbc, Names, Needed, read_dbc
from hil.core.can.frames import crc8, crc8_many
from hil.core.can.signals import FrameLayout, Payloads
from hil.core.channels import TICK_S
from hil.core.controller import Controller
from hil.core.errors import BadInputError, BenchError, DeviceError
from hil.core.errors.wording import printable

MODES = {"off": 0, "motor_torque": 1, "driving_torque": 2}
_COUNTER_VALUES = 16
_SHORTEST_COUNTER = 3  # bits; a shorter one says less than the order of the frames
_REPLY_TIMEOUT_S = 0.2
_ASKED_AGAIN_S = 0.04
_SILENT_S = 0.2
_NOT_BELIEVED_S = 0.05
_READ, _WRITE, _APPLY = 0, 1, 2
_FIRST_PARAMETER = 1
_SENT_BY_IT = ("RMCU_Status", "RMCU_Control")
_VERSION = ("SoftwareMajor", "SoftwareMinor", "SoftwarePatch")
_IDENTIFICATION = (*_VERSION, "HardwareRevision", "CalibrationId")
_IDENTIFIES_WITHIN_S = 1.2
_NEEDED = {
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
        ("DrivingTorqueRef", "DrivingTorqueEst", "State", "RequestFault"),
        whole=("State", "RequestFault", "Counter", "Crc"),
        units={"DrivingTorqueRef": "N m", "DrivingTorqueEst": "N m"},
        texts={"State": ("off",)},
        optional=("Counter", "Crc"),
    ),
    "RMCU_Identification": Needed((), whole=_IDENTIFICATION, optional=_IDENTIFICATION, may_miss=True),
    "RMCU_ParameterWrite": Needed(("Command", "Index", "Value"), whole=("Command", "Index")),
    "RMCU_ParameterReply": Needed(
        ("Command", "Result", "Index", "Value"), whole=("Command", "Result", "Index")
    ),
    "RCS_Vehicle": Needed(("VehicleSpeed",), units={"VehicleSpeed": "m/s"}),
}


# What the bench does not look at, but an RMCU's frames may hold: names for it can be given too.
_ALSO = {
    "RMCU_Control": ("Saturated", "ParametersValid"),
    "RCS_Vehicle": ("Counter", "Valid", "Crc"),
}

#: Messages of an RMCU with their signals, by our names, which are those of benches/rmcu.dbc.
RMCU_SIGNALS = {
    name: (*needed.signals, *needed.optional, *_ALSO.get(name, ())) for name, needed in _NEEDED.items()
}


def read_rmcu(dbc: Path, names: Names | None = None) -> Dbc:
    """What the driver uses of the RMCU's DBC, which calls things by `names`.

    Raises:
        BadInputError: it lacks a message or signal that is needed, or describes one that cannot be used.
    """
    return read_dbc(dbc, _NEEDED, names)


class RmcuDriver:
    """Requests, parameters and state of the RMCU: a `MotorControl`.

    Raises:
        BadInputError: the DBC lacks a message or signal that is needed, or describes one that cannot be used.
    """

    name = "RMCU"
    heartbeat_s = None  # its requests expire: it needs no other sign of life
    safe_within_s = 0.5

    def __init__(self, loop: BusLoop, wire: Wire, dbc: Path, names: Names | None = None) -> None:
        self._loop, self._wire = loop, wire
        read = read_rmcu(dbc, names)
        self._layouts, self._texts, self._dbc = read.layouts, read.texts, dbc
        self._request = self._layouts["RMCU_Request"]
        self._reply = self._layouts["RMCU_ParameterReply"]
        self._state_names = self._names("RMCU_Control", "State")
        self._fault_names = self._names("RMCU_Control", "RequestFault")
        self._shown = (self._layouts["RMCU_Control"].id, self._layouts["RMCU_Status"].id)
        self._counter = 0
        self._answer: int | None = None
        self._awaited = (0, 0)
        self.state = ""
        self.fault = ""
        self.torque_ref_nm = math.nan
        self.last_seen_s = -math.inf
        self._damaged_s = self._stands_s = -math.inf  # when a frame came whose checksum or count was wrong
        self._count: int | None = None
        shown = (self._layouts["RMCU_Control"], self._layouts["RMCU_Status"])
        self._damage = FrameDamage(wire.name, {name: self._layouts[name] for name in _SENT_BY_IT})
        self._newest = NewestFrames({frame.id: frame.signals.values() for frame in shown})
        self._identification: int | None = None
        if "RMCU_Identification" in self._layouts:
            loop.on_frame(wire, self._layouts["RMCU_Identification"].id, self._take_identification)
        checked = {frame.id: frame.signals["Crc"] for frame in shown if has_checksum(frame)}
        source = FrameSource(self._bindings(), TICK_S, self._counted_by(), checked)
        self.sources = (source,)
        loop.on_frame(wire, self._reply.id, self._take_reply)
        loop.on_block(self._take_block)
        loop.on_block(source.take)

    def _bindings(self) -> list[Binding]:
        """Where the RMCU's channels lie on its bus; the first is the time base of a recording."""
        status, control = self._layouts["RMCU_Status"], self._layouts["RMCU_Control"]
        bus = self._wire.name
        return [
            Binding(bus, status.id, status.signals["MotorSpeed"], "motor_speed_rad_s"),
            Binding(bus, status.id, status.signals["MotorTorqueRef"], "motor_torque_ref_nm"),
            Binding(bus, status.id, status.signals["MotorTorque"], "motor_torque_nm"),
            Binding(bus, control.id, control.signals["DrivingTorqueRef"], "driving_torque_ref_nm"),
            Binding(bus, control.id, control.signals["DrivingTorqueEst"], "driving_torque_est_nm"),
        ]

    def _counted_by(self) -> CountedBy:
        """What counts its samples: the longer of both frames' counters, else the status frames themselves."""
        found = [
            (counter.length, message)
            for message in ("RMCU_Control", "RMCU_Status")
            if (counter := self._layouts[message].signals.get("Counter")) is not None
            and counter.length >= _SHORTEST_COUNTER
        ]
        if found:
            _, message = max(found, key=lambda one: one[0])
            layout = self._layouts[message]
            # The control frame follows the status of its sample.
            opens = message == "RMCU_Status"
            return CountedBy(self._wire.name, layout.id, message, layout.signals["Counter"], opens=opens)
        return CountedBy(self._wire.name, self._layouts["RMCU_Status"].id, "RMCU_Status", opens=True)

    def come_up(self) -> None:
        """Nothing to configure: it must have sent its status by now.

        Raises:
            BenchError: it has not.
        """
        if self.state == "":
            raise BenchError(
                "the RMCU sends no status", where="RMCU", fix="check that it is powered and on this bus"
            )

    def beat(self) -> None:
        """Not needed."""

    def troubles(self) -> list[str]:
        """Its fault, if it is in one; frames that are not to be believed."""
        found = [f"the RMCU went to fault: {self.fault}"] if self.state == "fault" else []
        unseen = self._loop.clock.now_s() - self.last_seen_s > _NOT_BELIEVED_S
        if unseen and self._damaged_s > self.last_seen_s:
            found.append("the RMCU's frames come with wrong checksums")
        if unseen and self._stands_s > self.last_seen_s:
            found.append("the RMCU's counter stands still")
        return found

    @property
    def damage(self) -> str:
        """Which of its frames came damaged, and how many of how many; empty if none to speak of."""
        return str(self._damage)

    def close(self) -> None:
        """Nothing of its own is open."""

    def identify(self) -> dict[str, str]:
        """Software, hardware revision and checksum of the calibration, if its DBC has a message for them.

        And which of the frames that carry its values have no checksum or no counter, if any.
        """
        layout = self._layouts.get("RMCU_Identification")
        if self._loop.clock.now_s() - self.last_seen_s >= _SILENT_S:
            return {}
        return self._unprotected() | (self._asked_who(layout) if layout else {})

    def _unprotected(self) -> dict[str, str]:
        frames = {name: self._layouts[name] for name in _SENT_BY_IT}
        found = {
            "frames without checksum": [name for name, one in frames.items() if not has_checksum(one)],
            "frames without counter": [name for name, one in frames.items() if "Counter" not in one.signals],
        }
        return {what: ", ".join(names) for what, names in found.items() if names}

    def _asked_who(self, layout: FrameLayout) -> dict[str, str]:
        self._loop.wait_for(lambda: self._identification is not None, _IDENTIFIES_WITHIN_S)
        if self._identification is None:
            return {}
        raw = {
            name: layout.signals[name].raw(self._identification)
            for name in _IDENTIFICATION
            if name in layout.signals
        }
        found = {"software": ".".join(str(raw[name]) for name in _VERSION if name in raw)}
        if "HardwareRevision" in raw:
            found["hardware"] = str(raw["HardwareRevision"])
        if "CalibrationId" in raw:
            found["calibration"] = f"{raw['CalibrationId']:0{layout.signals['CalibrationId'].length // 4}X}"
        return {name: value for name, value in found.items() if value}

    def examine(self, *, ask: bool) -> Examined:
        """State, and whether it hears what is sent to it; reads a parameter, writes none."""
        where = f"RMCU (bus '{self._wire.name}')"
        if self._loop.clock.now_s() - self.last_seen_s > _SILENT_S:
            shown = " and ".join(f"0x{number:03X}" for number in sorted(self._shown))
            stopped = "has stopped sending its" if self.state else "sends no"
            fix = "switch it on; check its bus in the bench file, and that the DBC is the one of its software"
            return Examined(findings=[Finding("fault", f"{stopped} status (frames {shown})", where, fix)])
        found = Examined(answers=True, facts={"state": self.state})
        if self.state == "fault":
            found.facts["fault"] = self.fault
            fix = (
                "a run starts with a request for off, which clears the fault; if it returns, remove its cause"
            )
            found.findings.append(Finding("hint", f"is in fault: {self.fault}", where, fix))
        if ask:
            try:
                self._transact(_READ, _FIRST_PARAMETER, 0.0, "number 1")
                found.facts["answers parameter reads"] = "yes"
            except DeviceError:
                found.facts["answers parameter reads"] = "no"
                what = "sends its status, but does not answer when a parameter is read"
                fix = "check that the adapter can send (not listen-only), and RMCU_ParameterWrite in the DBC"
                found.findings.append(Finding("fault", what, where, fix))
        return found

    def requests(self, mode: str, values_nm: npt.NDArray[np.float64]) -> Payloads:
        """Payloads of consecutive request frames (N m), with counter and CRC, to be sent one each tick."""
        counters = (self._counter + np.arange(len(values_nm))) % _COUNTER_VALUES
        self._counter = (self._counter + len(values_nm)) % _COUNTER_VALUES
        payloads = self._request.encode(Counter=counters, Mode=MODES[mode], TorqueRequest=values_nm)
        payloads |= self._request.signals["Crc"].encode(crc8_many(self._request.id, payloads))
        return payloads

    def take_back(self, count: int) -> None:
        """The last `count` requests will not be sent: the RMCU would miss them in their counter."""
        self._counter = (self._counter - count) % _COUNTER_VALUES

    def send(self, payload: int) -> None:
        """Send one payload made by `requests`."""
        self._wire.send(self._request.id, int(payload).to_bytes(8, "little")[: self._request.length])

    def send_ahead(self, payloads: Payloads, times_s: npt.NDArray[np.float64]) -> bool:
        """Hand over payloads made by `requests`, each with its time; False if the wire takes none ahead."""
        if self._wire.takes_ahead:
            self._wire.send_ahead(self._request.id, payloads, self._request.length, times_s)
        return self._wire.takes_ahead

    def make_safe(self) -> None:
        """Ask for torque off, now."""
        self.send(self.requests("off", np.zeros(1))[0])

    def is_safe(self) -> bool:
        """Whether the RMCU says that it gives no torque, and says so now."""
        return self.state == "off" and self.is_powerless()

    def is_powerless(self) -> bool:
        """Whether it asks for no torque now: off, or in the fault to which it goes without requests."""
        fresh = self._loop.clock.now_s() - self.last_seen_s < 0.05
        return fresh and self.state in ("off", "fault") and self.torque_ref_nm == 0.0

    def write_controller(self, controller: Controller) -> None:
        """Write every parameter, read each back, apply.

        Raises:
            BenchError: no reply, a value that did not arrive as sent, or a refusal.
        """
        for name, value in parameters_of(controller).items():
            self._write(name, value)
        self._transact(_APPLY, 0, 0.0, "apply")

    def _write(self, name: str, value: float) -> None:
        index = self._texts.get(("RMCU_ParameterWrite", "Index"), {}).get(name)
        if index is None:
            raise BadInputError(
                f"signal 'Index' of 'RMCU_ParameterWrite' has no parameter named '{name}' (VAL_)",
                where=str(self._dbc),
                fix="use a DBC that fits this controller",
            )
        answer, sent = self._transact(_WRITE, index, value, name)
        if answer != sent:
            raise DeviceError(f"parameter '{name}' reads back as {answer:g}, {sent:g} was sent", where="RMCU")

    def _transact(self, command: int, index: int, value: float, name: str) -> tuple[float, float]:
        """The value of the reply, and the one that was sent, as its signal rounds it."""
        layout = self._layouts["RMCU_ParameterWrite"]
        payload = int(layout.encode(Command=command, Index=index, Value=value)[0])
        if not self._ask_until_answered(payload, command, index):
            raise DeviceError(
                f"no reply to parameter '{name}' within {_REPLY_TIMEOUT_S:g} s",
                where="RMCU",
                fix="check that the RMCU is powered and on this bus",
            )
        assert self._answer is not None
        signals = self._reply.signals
        result = signals["Result"].raw(self._answer)
        if result != 0:
            reason = self._names("RMCU_ParameterReply", "Result").get(result, str(result))
            raise DeviceError(f"refused parameter '{name}' = {value:g}: {reason}", where="RMCU")
        return signals["Value"].value(self._answer), layout.signals["Value"].value(payload)

    def _ask_until_answered(self, payload: int, command: int, index: int) -> bool:
        """Ask, and again as long as there is time: a frame may be lost, and twice is as once."""
        layout, clock = self._layouts["RMCU_ParameterWrite"], self._loop.clock
        self._answer, self._awaited = None, (command, index)
        until_s = clock.now_s() + _REPLY_TIMEOUT_S
        while (left_s := until_s - clock.now_s()) > 0.0:
            self._wire.send(layout.id, payload.to_bytes(8, "little")[: layout.length])
            if self._loop.wait_for(lambda: self._answer is not None, min(_ASKED_AGAIN_S, left_s)):
                return True
        return False

    def _names(self, message: str, signal: str) -> dict[int, str]:
        """The value table of a signal, by number."""
        table = self._texts.get((message, signal), {})
        return {number: printable(text) for text, number in table.items()}

    def _take_reply(self, frame_id: int, data: bytes, time_s: float) -> None:
        del frame_id, time_s
        answer, signals = int.from_bytes(data, "little"), self._reply.signals
        if (signals["Command"].raw(answer), signals["Index"].raw(answer)) == self._awaited:
            self._answer = answer  # and not that to an earlier one, which was asked twice

    def _take_identification(self, frame_id: int, data: bytes, time_s: float) -> None:
        del frame_id, time_s
        self._identification = int.from_bytes(data, "little")

    def _take_block(self, bus: str, block: npt.NDArray[np.void]) -> None:
        if bus != self._wire.name:
            return
        self._damage.take(block)
        control, status = self._newest.of(block)
        if control is None or status is None or not self._is_believed(*control):
            return
        signals = self._layouts["RMCU_Control"].signals
        self.last_seen_s, payload = control
        self.state = self._state_names.get(signals["State"].raw(payload), "?")
        self.fault = self._fault_names.get(signals["RequestFault"].raw(payload), "?")
        shown = self._layouts["RMCU_Status"]
        if not self._is_damaged(shown, status[1]):
            self.torque_ref_nm = shown.signals["MotorTorqueRef"].value(status[1])

    def _is_believed(self, time_s: float, payload: int) -> bool:
        """Whether a control frame is whole, and not the one that came before."""
        control = self._layouts["RMCU_Control"]
        if self._is_damaged(control, payload):
            self._damaged_s = time_s
            return False
        counter = control.signals.get("Counter")
        before, self._count = self._count, counter.raw(payload) if counter else None
        if self._count is not None and self._count == before:
            self._stands_s = time_s
            return False
        return True

    def _is_damaged(self, frame: FrameLayout, payload: int) -> bool:
        """Whether a frame's checksum is not that of its content."""
        return has_checksum(frame) and frame.signals["Crc"].raw(payload) != crc8(frame.id, payload)
