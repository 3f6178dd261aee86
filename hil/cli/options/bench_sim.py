"""`hil bench sim`: the simulated bench as a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_bench

SEVERAL = ("--hide", "--interface")


@dataclass(frozen=True, kw_only=True)
class BenchSim:
    """Serve the simulated RMCU and dynos in real time to `hil run` and other processes.

    Prints the bench file that connects to it, and serves until Ctrl-C or SIGTERM. Exit code: 0 the
    time of --for is over, 2 bad input, 3 a port is in use, 130 ended by a signal.
    """

    bench: Annotated[
        str,
        typer.Argument(
            help="bench file with [simulation], or the name of a shipped one", autocompletion=shipped_bench()
        ),
    ]
    time_scale: Annotated[
        float,
        typer.Option(help="bench seconds per real second; below 1 if the machine is too slow for real time"),
    ] = 1.0
    seed: Annotated[
        int | None, typer.Option(help="random seed of sensor noise; default: the bench file's")
    ] = None
    hide: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EFFECT=VALUE", help="additional effect of the bench that its model lacks: backlash=0.01"
        ),
    ] = None
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    transport: Annotated[str, typer.Option(help="udp, slcan (pseudo-terminals), socketcand or socketcan")] = (
        "udp"
    )
    port: Annotated[int, typer.Option(help="first port on 127.0.0.1; 0 takes free ones")] = 47110
    interface: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[:HOSTS]",
            help="SocketCAN interface: first RMCU bus, then dyno bus; vcan0, or can1:can0 (hosts on can0)",
        ),
    ] = None
    bench_file: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="also write the bench file that connects to it to FILE"),
    ] = None
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )
