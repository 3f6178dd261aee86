"""`hil bench agent`: benches of this machine for a bench service elsewhere, until somebody ends it."""

from __future__ import annotations

import math
import os
import socket
import sys

from hil.agent import AgentRequest, work
from hil.app.interrupts import EXIT_CODE
from hil.cli.options.benches import BenchAgent
from hil.cli.output import print_json
from hil.cli.remote_run import TOKEN
from hil.core.errors import BadInputError
from hil.core.errors.wording import printable
from hil.engine import StopRequest


def execute(options: BenchAgent) -> int:
    """Execute the command; its exit code."""
    server = options.server
    data = options.data
    bench = options.bench or ["sim"]
    name = options.name
    for_s = options.for_s
    if for_s is not None and not for_s > 0:
        raise BadInputError(f"--for is {for_s:g}", fix="give seconds greater than 0, or leave it out")
    name = name or socket.gethostname()
    if not name.strip() or not name.isprintable() or len(name) > 100:
        raise BadInputError(
            f"'{printable(name)}' is not a valid name",
            where="--name",
            fix="use 1 to 100 printable characters",
        )
    stop = StopRequest()

    def ready(away: str) -> None:
        if options.as_json:
            print_json({"agent": name, "servers": server, "data": str(data.resolve()), "away": away})
        elif away:
            print(f"Agent {name} is ready; the service cannot be reached, the agent retries: {away}")
        else:
            print(f"Agent {name} works for {server[0]} (Ctrl-C ends it); data directory: {data}")
        sys.stdout.flush()

    request = AgentRequest(
        servers=server,
        folder=data,
        benches=bench,
        token=os.environ.get(TOKEN, ""),
        name=name,
        local_days=options.keep_local,
        for_s=math.inf if for_s is None else for_s,
        ready=ready,
        stop=stop,
    )
    with stop.by_signals():
        work(request)
    return EXIT_CODE if stop.times else 0
