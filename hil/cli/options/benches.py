"""Options of the commands of benches and of the service."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from hil.cli.completion import shipped_bench
from hil.cli.options._shared import BenchArgument, DefaultBenchArgument, JsonObject


@dataclass(frozen=True, kw_only=True)
class BenchDoctor:
    """Check which devices are connected and answer; report faults and remedies.

    Listens first, then reads from every device. Writes nothing to a device and moves nothing. Exit code: 0 no
    fault (hints do not count), 1 faults were found, 2 the bench file cannot be used, 3 neither RMCU nor dynos
    answer.
    """

    bench: DefaultBenchArgument = ""
    for_s: Annotated[
        float, typer.Option("--for", metavar="SECONDS", help="time to listen before the devices are read")
    ] = 2.0
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class BenchMonitor:
    """Show decoded channels and bus load live; no frame is sent, not even a heartbeat.

    Prints a table that updates on a terminal, else a line per update. Exit code: 0 the time of --for is over,
    2 bad input or a simulated bench, 3 no bus can be opened or one fails, 130 ended by Ctrl-C.
    """

    bench: BenchArgument
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    every_s: Annotated[
        float | None,
        typer.Option(
            "--every", metavar="SECONDS", help="time between two updates; default: 0.2 on a terminal, else 1"
        ),
    ] = None
    as_json: Annotated[
        bool,
        typer.Option("--json", help="print one JSON object for the whole time, nothing else"),
    ] = False


@dataclass(frozen=True, kw_only=True)
class BenchJog:
    """Turn the axle at low torque and check the sign of every torque and speed.

    The axle moves: an operator is asked before, and whether the wheels turned forwards. Exit code: 0 every
    sign is right, 1 one is wrong or was not seen, 2 bad input, 3 the bench failed, 130 interrupted.
    """

    bench: BenchArgument
    torque: Annotated[float, typer.Option(metavar="NM", help="motor torque, N m")] = 10.0
    out: Annotated[
        Path | None,
        typer.Option(help="directory for recording and jog.json; default: out/jog-001 and so on"),
    ] = None
    operator: Annotated[str, typer.Option(help="name of the person who runs the bench")] = ""
    yes: Annotated[
        str,
        typer.Option(
            "--yes", metavar="NAME", help="name of the person who confirms all operator prompts in advance"
        ),
    ] = ""
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace an earlier jog in --out")] = False
    as_json: Annotated[bool, typer.Option("--json", help="print jog.json on stdout, nothing else")] = False


@dataclass(frozen=True, kw_only=True)
class BenchReset:
    """Reset an emergency stop, so that the bench can be armed again. Nothing moves.

    First make sure that no one is in danger and that the cause of the stop is removed.
    """

    bench: BenchArgument
    by: Annotated[
        str,
        typer.Option(
            "--by", metavar="NAME", help="name of the person who checked that it is safe; kept in the record"
        ),
    ]
    data: Annotated[
        Path | None,
        typer.Option(
            "--data",
            metavar="DIR",
            help="data directory of the service or agent that drives this simulated bench",
        ),
    ] = None
    as_json: JsonObject = False


@dataclass(frozen=True, kw_only=True)
class BenchSim:
    """Serve the simulated RMCU and dynos in real time to `hil run` and other processes.

    Prints the bench file that connects to it, and serves until Ctrl-C or SIGTERM. Exit code: 0 the
    time of --for is over, 2 bad input, 3 a port is in use, 130 ended by a signal.
    """

    SEVERAL = ("--hide", "--interface")

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


@dataclass(frozen=True, kw_only=True)
class BenchAgent:
    """Drive benches of this machine for a bench service on another machine.

    The service holds the queue and the page. The agent works until Ctrl-C or SIGTERM; it then ends runs
    under way with their end steps. When the service is out of reach, a run continues and is uploaded later.
    HIL_TOKEN holds a token with the role agent. Exit code: 0 the time of --for is over, 2 bad input, 3 the
    service has another bench of that name, 130 ended by a signal.
    """

    SEVERAL = ("--bench", "--server")

    server: Annotated[
        list[str],
        typer.Option(
            metavar="URL", help="address of the service; repeat it for several services with one database"
        ),
    ]
    data: Annotated[
        Path, typer.Option(metavar="DIR", help="directory that keeps runs until the service has them")
    ]
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None
    name: Annotated[
        str, typer.Option(help="name of this agent in the service; default: this machine's name")
    ] = ""
    keep_local: Annotated[
        float,
        typer.Option(
            min=0, metavar="DAYS", help="days to keep files in DIR after their upload to the service"
        ),
    ] = 30.0
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )


@dataclass(frozen=True, kw_only=True)
class Serve:
    """Run the bench service, which shares benches: a run queue, a REST API and a live page.

    Serves until Ctrl-C or SIGTERM; it then ends runs under way with their end steps. Without tokens it
    accepts connections from this machine only. Exit code: 0 the time of --for is over, 2 bad input, 3 the
    port is in use or the database cannot be used, 130 ended by a signal.
    """

    SEVERAL = ("--bench", "--allow-host", "--trusted-proxy")

    data: Annotated[Path, typer.Option(metavar="DIR", help="directory for runs, plans and the database")]
    bench: Annotated[
        list[str] | None, typer.Option(help="bench files, or names of shipped benches; default: sim")
    ] = None
    no_bench: Annotated[
        bool, typer.Option("--no-bench", help="serve only benches of agents, none of this machine")
    ] = False
    host: Annotated[
        str, typer.Option(help="address to listen on; any other than the loopback needs tokens")
    ] = "127.0.0.1"
    port: Annotated[int, typer.Option(min=0, max=65535, help="port; 0 takes a free one")] = 8080
    stop_port: Annotated[
        int | None,
        typer.Option(
            min=0, max=65535, help="port of the stop post; default: the one after --port; 0 takes a free one"
        ),
    ] = None
    stop_url: Annotated[
        str,
        typer.Option(metavar="URL", help="address of the stop post for browsers, if it is behind a proxy"),
    ] = ""
    trusted_proxy: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ADDRESS",
            help="address of a proxy whose headers for client address and TLS are trusted",
        ),
    ] = None
    allow_host: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="additional host name that browsers may use for the service"),
    ] = None
    database: Annotated[
        str,
        typer.Option(
            metavar="URL",
            envvar="HIL_DATABASE",
            help="database instead of SQLite in DIR: postgresql://user@host/name",
        ),
    ] = ""
    store: Annotated[
        str,
        typer.Option(
            metavar="URL",
            help="second place for files of runs: s3://bucket/prefix, or a folder on another disk",
        ),
    ] = ""
    recordings_gb: Annotated[
        float, typer.Option(min=0, metavar="GB", help="most that recordings given to the service may take")
    ] = 100.0
    keep_local: Annotated[
        float,
        typer.Option(min=0, metavar="DAYS", help="days to keep files in DIR after they are in the store"),
    ] = 30.0
    workers: Annotated[
        int | None,
        typer.Option(min=0, max=1024, help="worker processes for campaigns; default: all processors but one"),
    ] = None
    scheduler: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="address of a dask.distributed scheduler; use its workers instead"
        ),
    ] = ""
    rate: Annotated[
        float,
        typer.Option(
            min=1,
            metavar="N",
            help="requests per second allowed for a client address; a proxy counts as one client",
        ),
    ] = 40.0
    for_s: Annotated[float | None, typer.Option("--for", metavar="SECONDS", help="stop after this time")] = (
        None
    )
    notices: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="TOML file of webhooks and mail for runs that end, fail or wait"),
    ] = None
    sign_in: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="TOML file: where people sign in by OpenID Connect, and their roles"
        ),
    ] = None
    test_notices: Annotated[
        bool, typer.Option("--test-notices", help="send a test to everyone in --notices, print it and exit")
    ] = False
    add_token: Annotated[
        str,
        typer.Option(
            metavar="NAME=ROLE",
            help="make a token, print it and exit; roles: viewer, operator, engineer, admin, agent",
        ),
    ] = ""
    token_days: Annotated[
        float, typer.Option(min=0.01, max=3650, metavar="DAYS", help="validity of that token, days")
    ] = 365.0
    as_json: Annotated[bool, typer.Option("--json", help="print one JSON object on stdout, nothing else")] = (
        False
    )
