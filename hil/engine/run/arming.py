"""From an open bench to one that is armed: who is there, what they are, what they read at rest.

What devices say that they are is compared with what the bench file expects.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from drivers import TICK_S, DeviceTable, Identifies, Incomplete
from hil.core.errors import BenchError
from hil.core.result import Identity
from hil.engine.bench.bench import Bench
from hil.engine.bench.request_timing import RequestTiming
from hil.engine.run.jit_warm_up import warm_up
from hil.engine.run.limits import LimitWatch
from hil.engine.run.recorder import KEEP_S, Recorder
from hil.engine.run.zero import ZeroCheck

_FIX = "load the software or calibration that is expected, or correct [{key}.expects] in the bench file"


def identities_of(key: str, table: DeviceTable, device: object) -> tuple[Identity, ...]:
    """What a device says, and what was expected of it and not answered.

    A name such as "software" under `expects` counts for the device and for each of its parts,
    "rear left: software" for that part.

    Args:
        key: of its table in the bench file.
    """
    answers: Mapping[str, str] = device.identify() if isinstance(device, Identifies) else {}
    found = [
        Identity(device=key, name=name, value=value, expected=_wanted(table, name))
        for name, value in answers.items()
    ]
    names = {part for name in answers for part in (name, name.rpartition(": ")[2])}
    unsaid = [
        Identity(device=key, name=name, value="", expected=wanted)
        for name, wanted in table.expects.items()
        if name not in names
    ]
    return (*found, *unsaid)


def _wanted(table: DeviceTable, name: str) -> str:
    return table.expects.get(name, table.expects.get(name.rpartition(": ")[2], ""))


def mismatch_in_words(identity: Identity) -> str:
    """What is wrong with one that does not match."""
    if not identity.value:
        return f"does not report its {identity.name}, the bench file expects {identity.expected}"
    return f"{identity.name} is {identity.value}, the bench file expects {identity.expected}"


def what_to_do(identity: Identity) -> str:
    """About one that does not match."""
    return _FIX.format(key=identity.device)


def refuse_others(identities: Iterable[Identity]) -> None:
    """Raises:
    BenchError: a device is not what the bench file expects.
    """
    wrong = [identity for identity in identities if not identity.matches]
    if wrong:
        text = "; ".join(f"{identity.device}: {mismatch_in_words(identity)}" for identity in wrong)
        raise BenchError(text, where="device identification", fix=what_to_do(wrong[0]))


LISTEN_S = 0.2
#: How often the loop says to who watches it that it turns, s of the bench's clock.
TURNED_S = 0.02
_REPEAT_S = 0.02


class Arming:
    """Brings a bench up and arms it; `armed`: from now on the safe state is owed, whatever happens.

    Args:
        turned: called every `TURNED_S` from when devices hear that their host lives.
    """

    def __init__(
        self,
        bench: Bench,
        recorder: Recorder,
        watch: LimitWatch,
        zero: ZeroCheck,
        timing: RequestTiming | None,
        turned: Callable[[], None] = lambda: None,
    ) -> None:
        self._bench, self._recorder, self._watch = bench, recorder, watch
        self._zero, self._timing, self._turned = zero, timing, turned
        *others, last = [device.name for device in bench.devices]
        self.names = f"{', '.join(others)} and {last}"
        self.armed = False
        self.identities: tuple[Identity, ...] = ()
        self.missing: tuple[str, ...] = ()

    def come_up(self) -> None:
        """Listen, ask, configure, read at rest, arm.

        Raises:
            BenchError: a device is missing, is not what is expected, or an interlock does not hold.
        """
        bench = self._bench
        self._identify()
        if not bench.simulated:
            warm_up(bench)
        bench.start_heartbeats(self._timing)
        if not bench.loop.clock.virtual:
            bench.loop.every(KEEP_S, self._recorder.keep)
        bench.loop.every(TURNED_S, self._turned)
        bench.rmcu.come_up()
        bench.dyno.come_up()
        for device in bench.further.values():
            self.armed = True  # what a further device does once it is up, only the device knows
            device.come_up()
        self._note_missing()
        refuse_others(self.identities)
        self._recorder.begin()
        self._zero.begin()
        bench.loop.run_for(LISTEN_S)
        self._zero.before()
        self._refuse_open_interlocks()
        self._watch.refuse_silence(bench.loop.clock.now_s())
        self._event("preflight", f"{self.names} answer")
        self.armed = True
        bench.rmcu.make_safe()
        self._leave_old_fault()
        self._refuse_torque()
        bench.dyno.enable(bench.file.dyno.speed_ramp_m_s2 / bench.file.vehicle.wheel_radius_m)
        self._watch.active = True
        self._event("arm", "drives enabled")

    def _refuse_open_interlocks(self) -> None:
        for reached, text in self._watch.standing():
            if reached.message:
                raise BenchError(text, where=f"interlock '{reached.name}'", fix=reached.message)

    def _refuse_torque(self) -> None:
        """No drive is enabled before the RMCU has reported, in sound frames, that it is off."""
        rmcu = self._bench.rmcu
        if not self._bench.loop.wait_for(rmcu.is_safe, rmcu.safe_within_s):
            why = "; ".join(rmcu.troubles()) or f"state '{rmcu.state}'"
            raise BenchError(
                f"the RMCU does not confirm that its torque is off: {why}",
                where="RMCU",
                fix="check whether another host requests torque: hil bench monitor shows the frames",
            )

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
        tables = self._bench.file.device_tables.values()
        remarks = [text for table in tables for text in table.remarks()]
        absent = (f"{name} is missing: {why}" for name, why in self._bench.missing.items())
        self.missing = (*absent, *parts, *remarks)
        for text in self.missing:
            self._event("missing", text)

    def _identify(self) -> None:
        """Listen, and ask the devices meanwhile what they are: asking makes no run longer."""
        bench, tables = self._bench, self._bench.file.device_tables
        clock = bench.loop.clock
        began_s = clock.now_s()
        bench.loop.run_for(LISTEN_S / 2)
        found = [identities_of(key, tables[key], device) for key, device in bench.devices_by_key.items()]
        self.identities = tuple(identity for several in found for identity in several)
        bench.loop.wait_for(lambda: clock.now_s() > began_s + LISTEN_S - 0.5 * TICK_S, LISTEN_S)
        identified = {f"{i.device}: {i.name}": i.value for i in self.identities if i.value}
        self._recorder.writer.describe("identification", identified)

    def _event(self, kind: str, text: str) -> None:
        self._recorder.event(self._bench.loop.clock.now_s(), kind, text)
