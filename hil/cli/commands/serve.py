"""`hil serve`: the bench service, until somebody ends it."""

from __future__ import annotations

import importlib.util
import math
import os
import sys
from typing import TYPE_CHECKING

from hil.app.interrupts import EXIT_CODE
from hil.cli.options.benches import Serve
from hil.cli.output import print_json
from hil.core.errors import BadInputError, BenchError
from hil.engine import StopRequest

if TYPE_CHECKING:
    from pathlib import Path

    from hil.service.jobs.campaigns import Simulating
    from hil.service.notices import NoticeSettings


def execute(options: Serve) -> int:
    """Execute the command; its exit code."""
    data = options.data
    bench = options.bench or []
    trusted_proxy = options.trusted_proxy or []
    allow_host = options.allow_host or []
    for_s = options.for_s
    # The extra 'service' brings what they need.
    from hil.service.notices import read_settings
    from hil.service.recordings import Room
    from hil.service.serving import ServeRequest, make_token, serve
    from hil.service.sign_in import read_settings as read_sign_in

    if for_s is not None and not for_s > 0:
        raise BadInputError(f"--for is {for_s:g}", fix="give seconds greater than 0, or leave it out")
    if bench and options.no_bench:
        raise BadInputError("--bench does not go with --no-bench", fix="leave one of them out")
    if options.add_token:
        name, _, role = options.add_token.rpartition("=")
        made = make_token(data, options.database, name, role, options.token_days)
        if options.as_json:
            print_json(made.model_dump(mode="json"))
        else:
            print(f"# token of {made.token.name}, {made.token.role}; it is printed only once\n{made.secret}")
        return 0
    notices = read_settings(options.notices) if options.notices is not None else None
    sign_in = read_sign_in(options.sign_in) if options.sign_in is not None else None
    if options.test_notices:
        return _test_notices(data, notices, as_json=options.as_json)
    stop = StopRequest()

    def ready(url: str) -> None:
        if options.as_json:
            print_json({"url": url, "data": str(data.resolve())})
        else:
            print(f"The bench service is at {url} (Ctrl-C ends it); data directory: {data}")
        sys.stdout.flush()

    request = ServeRequest(
        folder=data,
        benches=[] if options.no_bench else bench or ["sim"],
        simulating=_simulating(options.workers, options.scheduler),
        host=options.host,
        port=options.port,
        stop_port=options.stop_port,
        stop_url=options.stop_url,
        trusted_proxies=trusted_proxy,
        database=options.database,
        store=options.store,
        local_days=options.keep_local,
        room=Room(most_bytes=1e9 * options.recordings_gb),
        hosts=allow_host,
        rate=options.rate,
        for_s=math.inf if for_s is None else for_s,
        notices=notices,
        sign_in=sign_in,
        ready=ready,
        stop=stop,
    )
    with stop.by_signals():
        serve(request)
    return EXIT_CODE if stop.times else 0


def _test_notices(data: Path, notices: NoticeSettings | None, *, as_json: bool) -> int:
    """Exit code 3 if somebody does not get it.

    Raises:
        BadInputError: there is no --notices.
    """
    from hil.service.notices import Post, send_test

    if notices is None:
        raise BadInputError("--test-notices needs --notices FILE", where="--test-notices")
    outcomes = send_test(Post(data, notices))
    if as_json:
        print_json({"sent": [{"to": name, "problem": problem} for name, problem in outcomes]})
    else:
        for name, problem in outcomes:
            print(f"{name}: {problem or 'sent'}")
    return BenchError.exit_code if any(problem for _, problem in outcomes) else 0


def _simulating(workers: int | None, scheduler: str) -> Simulating:
    """Who simulates; without a word, all processors but one, which is left to runs.

    Raises:
        BadInputError: both are named.
    """
    from hil.service.jobs.campaigns import Simulating

    if scheduler and workers is not None:
        raise BadInputError("--workers does not go with --scheduler", where="--workers", fix="leave one out")
    if scheduler:
        return Simulating(scheduler=scheduler)
    if workers is None:
        dask = importlib.util.find_spec("distributed") is not None
        workers = max(1, len(os.sched_getaffinity(0)) - 1) if dask else 0
    return Simulating(workers=workers)
