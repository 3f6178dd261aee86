"""The RC-S's panel: remote, alarms, vehicle and road load, each written and read back.

Its serial line may go away and come back, as an adapter does that is plugged in again.
"""

from __future__ import annotations

from collections.abc import Mapping

from drivers.device import Examined, Finding
from drivers.loop import BusLoop
from drivers.samples import SampleSource
from drivers.serial_line import SerialLine
from hil.core.ak import BUSY, OFFLINE, UNKNOWN, Answer, Request, Telegrams, answer_of
from hil.core.errors import BenchError
from hil.core.errors.wording import printable
from hil.core.runtime.clock import Clock
from hil.core.vehicle import VehicleAndRoad

_AGAIN_S = 0.5


class ReturningLine:
    """A `SerialLine` that is opened anew, twice a second, while it is away.

    Raises:
        BenchError: it is not there to begin with.
    """

    def __init__(self, name: str, url: str, baud_rate: int, clock: Clock) -> None:
        self.name = name
        self._url, self._baud_rate, self._clock = url, baud_rate, clock
        self._line: SerialLine | None = SerialLine(name, url, baud_rate)
        self._tried_s = 0.0
        self.gone = ""  # why, while it is away

    def send(self, data: bytes) -> bool:
        """Write bytes; False if the line is away."""
        if self._line is not None:
            try:
                self._line.send(data)
                return True
            except BenchError as error:
                self._lose(error)
        return False

    def drain(self) -> bytes:
        """Every byte that came since the last call; none while the line is away."""
        if self._line is None:
            self._try_again()
        if self._line is not None:
            try:
                return self._line.drain()
            except BenchError as error:
                self._lose(error)
        return b""

    def close(self) -> None:
        """Let go of the port."""
        if self._line is not None:
            self._line.close()

    def _lose(self, error: BenchError) -> None:
        self.close()
        self._line, self.gone, self._tried_s = None, error.what, self._clock.now_s()

    def _try_again(self) -> None:
        now_s = self._clock.now_s()
        if now_s - self._tried_s < _AGAIN_S:
            return
        self._tried_s = now_s
        try:
            self._line, self.gone = SerialLine(self.name, self._url, self._baud_rate), ""
        except BenchError as error:
            self.gone = error.what


REMOTE, STATE, ALARMS, RESET = "SREM", "ASTZ", "ASTF", "SRES"
_ATTEMPTS = 3
_BUSY_S, _LONGEST_BUSY_S = 0.1, 3.0
_NEAR = 1e-4  # what reads back may be rounded by, as a share
_NO_ANSWER: Answer | None = None
_IN_WORDS = {
    "SE": "does not understand it",
    "DF": "refuses the value",
    "OF": "is not in remote mode: it is operated by hand",
    "NA": "does not know it",
}
#: What can be set: code to write, code to read, name, unit, and the panel's units in one of ours.
_SETTINGS = {
    "mass_kg": ("EMAS", "AMAS", "vehicle mass", "kg", 1.0),
    "f0_n": ("EFW0", "AFW0", "road load f0", "N", 1.0),
    "f1_ns_m": ("EFW1", "AFW1", "road load f1", "N s/m", 1.0),
    "f2_ns2_m2": ("EFW2", "AFW2", "road load f2", "N s²/m²", 1.0),
    "slip": ("ESLP", "ASLP", "slip", "%", 100.0),
    "friction_left": ("EMUL", "AMUL", "friction left", "", 1.0),
    "friction_right": ("EMUR", "AMUR", "friction right", "", 1.0),
}


class Panel:
    """A `Device` that measures nothing: it says how it is, and takes what the vehicle and the road are.

    Every exchange has a deadline and is repeated twice; a panel that is busy is asked again for 3 s. What
    comes on the line and is no answer, an echo of the request included, is passed over.
    """

    heartbeat_s = 0.5  # how often it is asked for its state and its alarms
    safe_within_s = 0.5

    def __init__(
        self,
        name: str,
        line: ReturningLine,
        loop: BusLoop,
        channel: int = 0,
        answers_within_s: float = 0.3,
        gone_after_s: float = 3.0,
    ) -> None:
        self.name = name
        self.sources: tuple[SampleSource, ...] = ()
        self._line, self._loop, self._channel = line, loop, channel
        self._within_s, self._gone_after_s = answers_within_s, gone_after_s
        self._telegrams = Telegrams()
        self._awaited, self._answer = "", _NO_ANSWER
        self._seen_s = loop.clock.now_s()
        self.state = ""
        self.alarms: tuple[str, ...] = ()
        loop.serve(line, self._take)

    def come_up(self) -> None:
        """Take it to remote, and see that it has no alarm; alarms that somebody may reset are reset once.

        Raises:
            BenchError: it does not answer, stays local, or keeps an alarm.
        """
        self._ask(REMOTE)
        self._look()
        if self.alarms:
            self._ask(RESET)
            self._look()
        if self.alarms:
            raise self._failed(f"has alarms: {', '.join(self.alarms)}", "remove their cause at the panel")
        if self.state != REMOTE:
            stands = {"SMAN": "local", "": "silent"}.get(self.state, printable(self.state, 20))
            raise self._failed(f"stays {stands}", "switch the panel to remote")

    def beat(self) -> None:
        """Ask for state and alarms; the answers are looked at when they come."""
        for function in (STATE, ALARMS):
            self._line.send(Request(function, (), self._channel).telegram())

    def troubles(self) -> list[str]:
        """Alarms, somebody who took it to local, silence."""
        found = [f"alarm {alarm}" for alarm in self.alarms]
        if self.state not in ("", REMOTE):
            found.append("the panel was switched to local")
        silent_s = self._loop.clock.now_s() - self._seen_s
        if silent_s > self._gone_after_s:
            why = f": {self._line.gone}" if self._line.gone else ""
            found.append(f"the panel has sent nothing for {silent_s:.1f} s{why}")
        return found

    def make_safe(self) -> None:
        """It moves nothing: the dynamometers do, and they have a safe state of their own."""

    def is_safe(self) -> bool:
        """It gives no torque."""
        return True

    def close(self) -> None:
        """Let go of the line."""
        self._line.close()

    def set_vehicle(self, vehicle: VehicleAndRoad) -> Mapping[str, str]:
        """Write vehicle and road load and read them back; what the panel confirmed, by name, with units.

        Raises:
            BenchError: no answer, a refusal, or another value than was written.
        """
        confirmed = {}
        for key, (write, read, name, unit, factor) in _SETTINGS.items():
            value = getattr(vehicle, key)
            if value is None:
                continue
            self._ask(write, f"{value * factor:.6g}")
            parts = self._ask(read)
            try:
                stands = float(parts[0])
            except (IndexError, ValueError):
                raise self._failed(f"{name} reads back as '{printable(' '.join(parts), 40)}'") from None
            if abs(stands - value * factor) > _NEAR * max(abs(value * factor), 1.0):
                raise self._failed(f"{name} reads back as {stands:g} {unit}, {value * factor:g} was written")
            confirmed[name] = f"{stands:g} {unit}".rstrip()
        return confirmed

    def examine(self, *, ask: bool) -> Examined:
        """State and alarms."""
        where = f"device '{self.name}'"
        if not ask:
            return Examined(answers=False, findings=[Finding("hint", "only answers requests", where)])
        try:
            self._look()
        except BenchError as error:
            return Examined(findings=[Finding.of(error)])
        found = Examined(answers=True, facts={"state": "remote" if self.state == REMOTE else "local"})
        found.findings += [
            Finding("fault", f"alarm {alarm}", where, "clear its cause") for alarm in self.alarms
        ]
        return found

    def _look(self) -> None:
        self._ask(STATE)
        self._ask(ALARMS)

    def _ask(self, function: str, *data: str) -> tuple[str, ...]:
        """One exchange; the data of the answer."""
        telegram = Request(function, data, self._channel).telegram()
        busy_until_s = self._loop.clock.now_s() + _LONGEST_BUSY_S
        attempts = 0
        while attempts < _ATTEMPTS:
            self._awaited, self._answer = function, None
            self._line.send(telegram)
            self._loop.wait_for(lambda: self._answer is not None, self._within_s)
            answer = self._answer
            if answer is None:
                attempts += 1
            elif answer.error == BUSY and self._loop.clock.now_s() < busy_until_s:
                self._loop.run_for(_BUSY_S)
            elif answer.error:
                raise self._refused(function, data, answer)
            else:
                return answer.data
        away = f" (the line is away: {self._line.gone})" if self._line.gone else ""
        raise self._failed(
            f"no answer to {function} in {_ATTEMPTS} attempts of {self._within_s:g} s{away}",
            "check that it is switched on and set to this baud rate",
        )

    def _refused(self, function: str, data: tuple[str, ...], answer: Answer) -> BenchError:
        if answer.error == BUSY:
            return self._failed(f"is busy for more than {_LONGEST_BUSY_S:g} s")
        why = _IN_WORDS.get(answer.error, f"says {printable(answer.error, 20)}")
        fix = (
            "switch the panel to remote"
            if answer.error == OFFLINE
            else "check that it matches this panel's software"
        )
        return self._failed(f"{' '.join((function, *data))}: the panel {why}", fix)

    def _failed(self, what: str, fix: str = "check the panel") -> BenchError:
        return BenchError(what, where=f"device '{self.name}'", fix=fix)

    def _take(self, data: bytes, time_s: float) -> None:
        for text in self._telegrams.feed(data):
            answer = answer_of(text)
            if answer is None:
                continue
            self._seen_s = time_s
            if answer.function == STATE and answer.data and not answer.error:
                self.state = answer.data[0]
            elif answer.function == ALARMS and not answer.error:
                self.alarms = tuple(printable(alarm, 20) for alarm in answer.data if alarm != "0")
            if answer.function in (self._awaited, UNKNOWN):
                self._answer = answer
