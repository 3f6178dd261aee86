"""`hil bench doctor`: tells people and programs how a bench was found."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from hil.cli.options.benches import BenchDoctor
from hil.cli.output import console, plain_table, print_json, progress
from hil.cli.run_inputs import bench_or_own
from hil.core.errors.wording import printable
from hil.engine import StopRequest, load_bench
from hil.engine.commissioning.doctor import BusFacts, DoctorRequest, Examination, examine_bench

_EXIT_CODES = {"fine": 0, "faults": 1, "not_there": 3}
_VERDICTS = {
    "fine": "[green]no fault found[/]",
    "faults": "[bold red]faults found[/]",
    "not_there": "[bold red]the bench does not respond[/]: neither RMCU nor dynos answer",
}
_COUNTERS = {"state": "", "transmit_errors": "transmit errors ", "receive_errors": "receive errors "}


def execute(options: BenchDoctor) -> int:
    """Execute the command; its exit code."""
    file = load_bench(bench_or_own(options.bench))
    with progress(f"checking {file.name}") as show:
        request = DoctorRequest(file, options.for_s, stop=StopRequest())
        request.progress = lambda share, text: show(text, share)
        found = examine_bench(request)
    if options.as_json:
        print_json(found.as_dict())
    else:
        _tell(found)
    return _EXIT_CODES[found.verdict]


def _tell(found: Examination) -> None:
    page = console()
    simulated = " (simulated, in this process)" if found.simulated else ""
    page.print(
        f"[bold]{printable(found.bench)}[/]{simulated}, listened for {found.listened_s:g} s\n",
        highlight=False,
    )
    page.print(_buses(found.buses))
    page.print()
    page.print(_devices(found))
    if found.clocks:
        page.print()
        page.print(_clocks(found))
    if found.zeros:
        page.print()
        page.print(_zeros(found))
    if found.calibration:
        dates = ", ".join(f"{printable(name)} {until}" for name, until in found.calibration.items())
        page.print(f"\ncalibrated until: {dates}", highlight=False, markup=False, soft_wrap=True)
    _tell_findings(page, found)


def _tell_findings(page: Console, found: Examination) -> None:
    page.print()
    for number, finding in enumerate(found.findings, 1):
        style = "bold red" if finding.severity == "fault" else "yellow"
        page.print(f"{number}. ", f"{finding.severity}: ", style=style, end="", sep="", highlight=False)
        text = f"{finding.where}: {finding.what}" if finding.where else finding.what
        page.print(printable(text, 1000), highlight=False, markup=False, soft_wrap=True)
        if finding.fix:
            page.print(f"   {printable(finding.fix, 1000)}", highlight=False, markup=False, soft_wrap=True)
    faults = sum(finding.severity == "fault" for finding in found.findings)
    counted = f" ({faults} faults, {len(found.findings) - faults} hints)" if found.findings else ""
    page.print(f"{_VERDICTS[found.verdict]}{counted}", highlight=False)


def _table(*columns: str, right: tuple[str, ...] = ()) -> Table:
    table = plain_table()
    for column in columns:
        table.add_column(column, justify="right" if column in right else "left", overflow="fold")
    return table


def _buses(buses: dict[str, BusFacts]) -> Table:
    table = _table("bus", "interface", "bit/s", "frames/s", "load", "errors", "controller",
                   right=("bit/s", "frames/s", "load", "errors"))  # fmt: skip
    for name, facts in buses.items():
        heard = ("-", "-", "-")
        if facts.opened:
            heard = f"{facts.frames_s:.0f}", f"{facts.load or 0:.0%}", str(facts.error_frames)
        texts = [
            f"{words}{facts.controller[key]}" for key, words in _COUNTERS.items() if key in facts.controller
        ]
        interface = f"{printable(facts.interface)} {printable(facts.channel)}"
        state = ", ".join(texts) or ("not available from this interface" if facts.opened else "not opened")
        table.add_row(printable(name), interface, str(facts.bit_rate), *heard, state)
    return table


def _devices(found: Examination) -> Table:
    table = _table("device", "answers", "data reported")
    words = {True: "yes", False: "[bold red]no[/]", None: "cannot be read"}
    for key, device in found.devices.items():
        lines = _by_part(device.facts)
        table.add_row(
            printable(key), words[device.answers], "\n".join(printable(line, 500) for line in lines)
        )
    return table


def _by_part(facts: dict[str, str]) -> list[str]:
    """A line for each part of a device: "rear left: drive" and "rear left: NMT" stand together."""
    parts: dict[str, list[str]] = {}
    for name, value in facts.items():
        part, _, what = name.rpartition(": ")
        parts.setdefault(part, []).append(f"{what} {value}")
    return [
        f"{part}: {', '.join(texts_of)}" if part else ", ".join(texts_of) for part, texts_of in parts.items()
    ]


def _clocks(found: Examination) -> Table:
    table = _table("clock", "counted by", "drift, ppm", "offset, ms", "latest, ms", "lost",
                   right=("drift, ppm", "offset, ms", "latest, ms", "lost"))  # fmt: skip
    for clock in found.clocks:
        times = f"{clock.drift_ppm:.0f}", f"{clock.offset_s * 1e3:.2f}", f"{clock.latest_s * 1e3:.1f}"
        table.add_row(clock.stream, clock.counted_by, *times, str(clock.lost))
    return table


def _zeros(found: Examination) -> Table:
    table = _table("sensor at rest", "reads", "limit", "unit", right=("reads", "limit"))
    for zero in found.zeros:
        reads = "not read" if zero.before is None else f"{zero.before:.4g}"
        limit = "not stated" if zero.within is None else f"{zero.within:g}"
        table.add_row(printable(zero.channel), reads, limit, zero.unit)
    return table
