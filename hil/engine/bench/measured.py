"""Whether a bench measures what its file limits: asked before a run, by a check and by the doctor."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from drivers import BusLoop, Device, Finding, LogWire
from hil.core.errors import BadInputError, BenchError
from hil.core.runtime.clock import WallClock
from hil.engine.bench.bench import connections_of, open_bench
from hil.engine.bench.bench_channels import refuse_channels
from hil.engine.bench.bench_tables import BenchFile
from hil.engine.bench.computed_channels import computed_channels


def refuse_unmeasured(file: BenchFile) -> None:
    """Refuse limits of channels that nothing measures, as a run does when it has opened the bench.

    A simulated bench is opened. Hardware is left alone: its devices on CAN are made on wires to nowhere.
    What a device elsewhere would measure (on a serial line) is then not known, and nothing is refused.

    Raises:
        BadInputError: which channel or key, and what to do.
    """
    if file.simulation is not None:
        with open_bench(file):
            return
    if any(getattr(table, "bus", None) is None for table in file.device_tables.values()):
        return
    clock = WallClock()
    loop = BusLoop(clock, [LogWire(bus, clock) for bus in file.buses])
    connections = connections_of(file, loop)
    devices: list[Device] = []
    try:
        for key, table in file.device_tables.items():
            devices.append(table.open(key.removeprefix("devices."), connections))
        _refuse(file, devices, loop, {})
    except BenchError:
        return  # a device that cannot be made without its bus: the run, which has it, asks
    finally:
        for device in devices:
            device.close()


def findings_of_channels(file: BenchFile, devices: Mapping[str, Device], loop: BusLoop) -> Iterable[Finding]:
    """The same of devices that were opened, by the keys of their tables; nothing without RMCU and dynos."""
    if not {"rmcu", "dyno"} <= devices.keys():
        return
    unopened = file.device_tables.keys() - devices.keys()
    missing = {key.removeprefix("devices."): "it cannot be opened" for key in sorted(unopened)}
    try:
        _refuse(file, devices.values(), loop, missing)
    except BadInputError as error:
        yield Finding("fault", error.what, error.where, error.fix)


def _refuse(file: BenchFile, devices: Iterable[Device], loop: BusLoop, missing: Mapping[str, str]) -> None:
    sources = [*(source for device in devices for source in device.sources), *computed_channels(file, loop)]
    refuse_channels(file, [stream for source in sources for stream in source.streams], missing)
