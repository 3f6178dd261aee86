"""Opens what of a bench can be opened, listens, asks, and says what is wrong; no device is written to."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial

from drivers import BusLoop, Connections, Device, Examinable, Finding, Wire
from hil.core.can.frames import FrameBlock
from hil.core.channels import CHANNELS
from hil.core.errors import BadInputError, BenchError
from hil.core.model import load_model
from hil.core.runtime.clock import undisturbed
from hil.core.runtime.versions import versions
from hil.engine.bench.bench import bench_clock, connections_of, open_wire
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.bus_tally import Tally, known_identifiers
from hil.engine.bench.measured import findings_of_channels
from hil.engine.commissioning.doctor._buses import Listener, findings_of_bus, findings_of_link
from hil.engine.commissioning.doctor.examination import (
    BusFacts,
    DeviceFacts,
    Examination,
    findings_of_dates,
    findings_of_stops,
)
from hil.engine.run.arming import identities_of, mismatch_in_words, what_to_do
from hil.engine.run.zero import SENSORS, offset_in_words, turning, zero_of
from hil.engine.run.zero import what_to_do as what_to_do_about_zero
from hil.engine.stop.stopping import StopRequest

_CHUNK_S = 0.1


@dataclass
class DoctorRequest:
    """A bench to be looked at.

    Attributes:
        listen_s: seconds of the bench clock to listen before anybody is asked.
        progress: called with the share that is done and what is going on.
    """

    bench: BenchFile
    listen_s: float = 2.0
    today: datetime.date = field(default_factory=lambda: datetime.datetime.now(datetime.UTC).date())
    progress: Callable[[float, str], None] = lambda share, text: None
    stop: StopRequest = field(default_factory=StopRequest)


def examine_bench(request: DoctorRequest) -> Examination:
    """Look at everything; what cannot be reached becomes a finding, and the rest is looked at all the same.

    Devices are only read: SDO uploads and parameter reads. If another host drives the bench, nothing is sent.

    Raises:
        BadInputError: the time to listen makes no sense.
        InterruptError: somebody asked to stop.
    """
    if not 0.2 <= request.listen_s <= 3600:
        raise BadInputError(f"--for is {request.listen_s:g}", fix="give 0.2 to 3600 seconds")
    with ExitStack() as opened:
        return _Visit(request, opened).pay()


class _Visit:
    def __init__(self, request: DoctorRequest, opened: ExitStack) -> None:
        self._request, self._file, self._opened = request, request.bench, opened
        file = request.bench
        dates = {sensor: until.isoformat() for sensor, until in file.calibration.items()}
        simulated = file.simulation is not None
        self._found = Examination(
            file.name, simulated, request.listen_s, calibration=dates, versions=versions()
        )
        self._tallies: dict[str, Tally] = {}

    def pay(self) -> Examination:
        found, request, opened = self._found, self._request, self._opened
        loop = self._open_buses()
        if not found.simulated:
            granted = opened.enter_context(undisturbed(collections=True))
            if not granted:
                fix = "allow it: '@hil - rtprio 1' in /etc/security/limits.conf, or CAP_SYS_NICE"
                what = "this system grants no real-time priority: other programs can delay a run"
                found.findings.append(Finding("hint", what, "this machine", fix))
        devices = self._open_devices(connections_of(self._file, loop, opened))
        listener = Listener([source for device in devices.values() for source in device.sources])
        with request.stop.by_signals(), request.stop.telling(partial(setattr, loop, "stop_requested", True)):
            self._forget_what_waited(loop, listener)
            duration_s = self._listen(loop, listener)
            self._describe_buses(loop.wires, duration_s)
            self._add(*listener.findings_of_rates(duration_s))
            self._look_for_other_hosts()
            self._ask(devices, readings := listener.means())
        self._add(*findings_of_channels(self._file, devices, loop))
        self._look_at_zero(readings)
        found.clocks, findings = listener.clocks()
        self._add(*findings, *findings_of_dates(self._file, request.today))
        self._add(*findings_of_stops(self._file))
        found.findings.sort(key=lambda finding: finding.severity != "fault")
        return found

    def _add(self, *findings: Finding) -> None:
        self._found.findings += [finding for finding in findings if finding not in self._found.findings]

    def _open_buses(self) -> BusLoop:
        file, wires = self._file, []
        model = load_model(file.simulation.model) if file.simulation else None
        clock, offset_s = bench_clock(file, model, self._opened)
        for name, bus in file.buses.items():
            facts = BusFacts(bus.interface, str(bus.channel), bus.bit_rate)
            self._found.buses[name] = facts
            try:
                wires.append(open_wire(file, name, clock, offset_s, self._opened))
                facts.opened = True
            except BenchError as error:
                self._add(Finding.of(error, f"bus '{name}'"))
            self._add(*findings_of_link(name, bus, facts))
            self._tallies[name] = Tally()
        return BusLoop(clock, wires)

    def _open_devices(self, connections: Connections) -> dict[str, Device]:
        """Those whose bus and port can be opened."""
        devices: dict[str, Device] = {}
        for key, table in self._file.device_tables.items():
            self._found.devices[key] = DeviceFacts(table.kind, answers=False)
            bus = getattr(table, "bus", None)
            if isinstance(bus, str) and bus not in connections.wires:
                continue  # reported with the bus
            try:
                devices[key] = table.open(key.removeprefix("devices."), connections)
                self._opened.callback(devices[key].close)
            except BenchError as error:
                self._add(Finding.of(error, key))
        return devices

    def _count(self, bus: str, block: FrameBlock) -> None:
        self._tallies[bus].take(block)

    def _forget_what_waited(self, loop: BusLoop, listener: Listener) -> None:
        """What came while buses and devices were opened, and while code was loaded, tells no rates."""
        try:
            loop.run_for(_CHUNK_S)
        except BenchError as error:
            self._add(Finding.of(error))
        listener.forget()

    def _listen(self, loop: BusLoop, listener: Listener) -> float:
        """Let time pass, seconds of the bench clock.

        A bus that fails is reported once and does not keep the others from being heard.
        """
        loop.on_drained(listener.take)
        loop.on_block(self._count)
        begin_s = loop.clock.now_s()
        chunks = max(1, round(self._request.listen_s / _CHUNK_S))
        for chunk in range(chunks):
            self._request.progress(0.8 * chunk / chunks, "listening")
            try:
                loop.run_for(self._request.listen_s / chunks)
            except BenchError as error:
                self._add(Finding.of(error))
        return loop.clock.now_s() - begin_s

    def _describe_buses(self, wires: list[Wire], duration_s: float) -> None:
        for wire in wires:
            facts, tally = self._found.buses[wire.name], self._tallies[wire.name]
            known = known_identifiers(self._file, wire.name)
            facts.load = round(tally.load(facts.bit_rate, duration_s), 4)
            facts.frames_s = round(tally.frames / duration_s, 1)
            facts.error_frames, facts.unknown = tally.errors, tally.unknown(known, duration_s)
            on_it = [t for t in self._file.device_tables.values() if getattr(t, "bus", None) == wire.name]
            expected = any(table.sends_by_itself() for table in on_it)
            self._add(*findings_of_bus(wire.name, facts, tally, wire, expected=expected))
            try:
                wire.check()
            except BenchError as error:
                self._add(Finding.of(error))

    def _look_for_other_hosts(self) -> None:
        for table in self._file.device_tables.values():
            bus = getattr(table, "bus", "")
            heard = self._tallies[bus].standard_ids if bus in self._tallies else set()
            asked = sorted(heard.intersection(table.asked_by_hosts()))
            if asked:
                self._found.asked = False
                words = table.identifiers()
                shown = ", ".join(words.get(number, f"0x{number:03X}") for number in asked)
                what = f"another host drives this bench: it sends {shown}. The devices were not read"
                fix = "wait until it has finished, or end it; two hosts on one bench trip the RMCU"
                self._add(Finding("fault", what, f"bus '{bus}'", fix))

    def _look_at_zero(self, readings: dict[str, float]) -> None:
        """What the sensors read, if the axle stands still."""
        limits, moving = self._file.zero, turning(readings)
        for name in dict.fromkeys((*SENSORS, *limits)):
            if name in readings or name in limits:
                unit = CHANNELS[name].unit if name in CHANNELS else ""
                value = None if moving else readings.get(name)
                zero = zero_of(name, unit, limits.get(name), value, None, moving or "nothing came")
                self._found.zeros.append(zero)
                if value is not None and not zero.offset_fits:
                    self._add(Finding("fault", offset_in_words(zero), "zero check", what_to_do_about_zero()))
        if moving and self._found.asked:
            self._add(
                Finding("hint", f"{moving}; sensors were not checked", "zero check", "bring it to rest")
            )

    def _ask(self, devices: dict[str, Device], readings: dict[str, float]) -> None:
        for key, device in devices.items():
            self._request.progress(0.9, f"reading {device.name}")
            facts = self._found.devices[key]
            if not isinstance(device, Examinable):
                facts.answers = None
                continue
            try:
                examined = device.examine(ask=self._found.asked)
            except BenchError as error:
                self._add(Finding.of(error, key))
                continue
            facts.answers, facts.facts = examined.answers, examined.facts
            self._add(*examined.findings)
            readings |= examined.readings
            if examined.answers and self._found.asked:
                self._identify(key, device, facts)

    def _identify(self, key: str, device: Device, facts: DeviceFacts) -> None:
        for identity in identities_of(key, self._file.device_tables[key], device):
            if identity.value:
                facts.facts[identity.name] = identity.value
            if not identity.matches:
                self._add(Finding("fault", mismatch_in_words(identity), device.name, what_to_do(identity)))
