"""`hil bench monitor`: a table that renews itself, or a line at each look."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict

from rich.console import Group, RenderableType
from rich.live import Live
from rich.table import Table
from rich.text import Text

from hil.app.interrupts import EXIT_CODE
from hil.cli.options.benches import BenchMonitor
from hil.cli.output import console, plain_table, print_json
from hil.core.errors.wording import printable
from hil.engine import StopRequest, load_bench
from hil.engine.commissioning.monitor import ChannelView, MonitorRequest, View, monitor

_EVERY_S = {True: 0.2, False: 1.0}  # on a terminal, and elsewhere


def execute(options: BenchMonitor) -> int:
    """Execute the command; its exit code."""
    file = load_bench(options.bench)
    terminal = sys.stdout.isatty() and not options.as_json
    stop = StopRequest()
    request = MonitorRequest(
        file, _EVERY_S[terminal] if options.every_s is None else options.every_s, stop=stop
    )
    if options.for_s is not None:
        request.for_s = options.for_s
    if not options.as_json:
        request.begin = _tell_notes
    with _shown(terminal=terminal, as_json=options.as_json) as show:
        request.show = show
        whole = monitor(request)
    if options.as_json:
        print_json(asdict(whole))
    return EXIT_CODE if stop.times else 0


def _tell_notes(notes: list[str]) -> None:
    for note in notes:
        print(f"# {printable(note, 500)}")
    sys.stdout.flush()


@contextlib.contextmanager
def _shown(*, terminal: bool, as_json: bool) -> Iterator[Callable[[View], None]]:
    """What takes the views."""
    if as_json:
        yield lambda view: None
    elif terminal:
        with Live(console=console(), auto_refresh=False) as live:
            yield lambda view: live.update(_tables(view), refresh=True)
    else:
        yield _print_line


def _print_line(view: View) -> None:
    """Everything of a look on one line: time, load of each bus, state of each device, newest values."""
    parts = [f"{view.time_s:.1f} s"]
    parts += [f"{name} {bus.load:.0%} {bus.frames_s:.0f}/s" for name, bus in view.buses.items()]
    parts += [f"{key}: {state}" for key, state in view.devices.items()]
    parts += [
        f"{name} {_number(channel.value)}" for name, channel in view.channels.items() if channel.samples_s > 0
    ]
    print(printable("  ".join(parts), 4000))
    sys.stdout.flush()


def _tables(view: View) -> RenderableType:
    buses = _table("bus", "load", "frames/s", "errors/s", "unknown")
    for name, bus in view.buses.items():
        unknown = ", ".join(list(bus.unknown)[:6])
        buses.add_row(
            printable(name), f"{bus.load:.1%}", f"{bus.frames_s:.0f}", f"{bus.errors_s:.0f}", unknown
        )
    channels = _table("channel", "value", "lowest", "highest", "unit", "samples/s")
    for name, channel in view.channels.items():
        channels.add_row(printable(name), *_cells(channel))
    states = "   ".join(f"{key}: {state}" for key, state in view.devices.items())
    return Group(Text(f"{view.time_s:.1f} s   {states}   Ctrl-C ends it"), Text(), buses, Text(), channels)


def _cells(channel: ChannelView) -> tuple[str, ...]:
    if channel.samples_s == 0:
        return "-", "-", "-", channel.unit, "0"
    values = (channel.value, channel.lowest, channel.highest)
    return (*map(_number, values), channel.unit, f"{channel.samples_s:.0f}")


def _number(value: float) -> str:
    return f"{value:.4g}"


def _table(first: str, *others: str) -> Table:
    table = plain_table()
    table.add_column(first, no_wrap=True)
    for name in others:
        left = name in ("unit", "unknown")
        table.add_column(name, justify="left" if left else "right", no_wrap=True, min_width=0 if left else 10)
    return table
