"""A service from its folder to its end."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import math
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import uvicorn
from sqlalchemy import Engine

from hil.api_schemas.api import ROLES, Role, RunData, TokenMade
from hil.core.errors import BadInputError, BenchError
from hil.core.errors.wording import printable
from hil.engine import StopRequest
from hil.execution.background import going_on
from hil.execution.benches import benches_of
from hil.execution.data_folder import alone_in, make_private, name_in
from hil.service.api import Guarding, Rates, StopAddress, application, bounded
from hil.service.archive import Archive
from hil.service.heard_speeds import HeardSpeeds
from hil.service.jobs.campaigns import Simulating
from hil.service.notices import NoticeSettings, NoticeWatch, Post
from hil.service.recordings import Room
from hil.service.service import Service
from hil.service.sign_in import SignIn, SignInSettings
from hil.service.stop_post import StopPost
from hil.service.store import BenchStore, LogStore, TokenStore, in_turns, open_database

_LOOK_S = 0.1
_LAST_ANSWERS_S = 2
#: For an SQLite that is locked the loop waits so long, once: then it is away until it can be written.
_LOCKED_S = 1.0
_STOP_POST_WITHIN_S = 30.0
_BACKLOG = 1024
#: Between them is read what has come: who sends a request is not pushed out by a burst of others.
_TAKEN_AT_ONCE = 8
_AT_ONCE_S = 5.0  # of the rate: a page that is opened asks for many things at once
_THIS_MACHINE = ("127.0.0.1", "localhost", "::1")
_OTHER_FOLDER = "give another folder with --data, or use that service"

logger = logging.getLogger(__name__)


@dataclass
class ServeRequest:
    """A service that is wanted.

    Attributes:
        folder: where everything is kept; made if it is not there.
        benches: bench files, or names of shipped ones.
        simulating: who simulates campaigns.
        database: by URL; '' for SQLite in the folder.
        store: of files of runs, by URL; '' keeps them in the folder only.
        local_days: how long files that the store has stay in the folder.
        hosts: further names by which browsers may call it.
        port: 0 takes a free one.
        stop_port: of the stop post; None takes the one after `port`, or a free one if that is 0.
        stop_url: where others reach the stop post, if that is not this host at `stop_port`.
        trusted_proxies: addresses of proxies before the service, which say for whom and how they ask.
        room: for recordings that people give.
        rate: requests that an address may send a second, in the long run.
        for_s: ends by itself after this many seconds.
        notices: who gets which; None: they are not sent.
        sign_in: where people sign in by OpenID Connect; None: there are tokens only.
        ready: called with the URL once it answers.
    """

    folder: Path
    benches: Sequence[str]
    simulating: Simulating = field(default_factory=Simulating)
    host: str = "127.0.0.1"
    port: int = 8080
    stop_port: int | None = None
    stop_url: str = ""
    trusted_proxies: Sequence[str] = ()
    database: str = ""
    store: str = ""
    local_days: float = 30.0
    hosts: Sequence[str] = ()
    room: Room = field(default_factory=Room)
    rate: float = 40.0
    for_s: float = math.inf
    notices: NoticeSettings | None = None
    sign_in: SignInSettings | None = None
    ready: Callable[[str], None] = lambda url: None
    stop: StopRequest = field(default_factory=StopRequest)


def serve(request: ServeRequest) -> None:
    """Serve until somebody asks to stop; runs under way are ended then, and their benches safe.

    Raises:
        BadInputError: folder, bench files or host cannot be used.
        BenchError: the port is taken, or the database cannot be used.
    """
    benches = benches_of(list(request.benches), request.folder.resolve())
    archive = Archive(request.store) if request.store else None
    with alone_in(request.folder, who="service", fix=_OTHER_FOLDER):
        engine = _database(request.folder, request.database, _LOCKED_S)
        try:
            sign_in = SignIn(request.sign_in) if request.sign_in is not None else None
            if sign_in is None:
                _refuse_open_to_all(request.host, TokenStore(engine))
            with (
                _listening(request.host, request.port, "--port") as listening,
                _listening(request.host, _stop_port(request), "--stop-port") as stop_listening,
            ):
                held = BenchStore(engine, name_in(request.folder, "service.id"), _place_of(request.folder))
                post = StopPost(stop_listening, _names(request), request.trusted_proxies)
                service = Service(
                    request.folder,
                    engine,
                    held,
                    benches,
                    request.simulating,
                    archive,
                    request.local_days,
                    post,
                    sign_in,
                    request.room,
                )
                asyncio.run(_served(request, service, listening, post))
        finally:
            engine.dispose()


def make_token(folder: Path, database: str, name: str, role: str, for_days: float = 365.0) -> TokenMade:
    """Make a token that is valid for so many days, whether the service runs or not.

    Raises:
        BadInputError: no such role, or no name.
    """
    if role not in ROLES:
        raise BadInputError(
            f"there is no role '{printable(role)}'", where="--add-token", fix=f"one of {', '.join(ROLES)}"
        )
    if not name.strip() or not name.isprintable() or len(name) > 100:
        raise BadInputError(
            "the name of the token is empty, too long or not printable",
            where="--add-token",
            fix="write NAME=ROLE, NAME with 1 to 100 printable characters",
        )
    make_private(folder)
    engine = _database(folder, database)
    try:
        chosen: Role = next(known for known in ROLES if known == role)
        made = TokenStore(engine).make(name.strip(), chosen, for_days)
        LogStore(engine).add("command line", "", "token made", name, f"{role}, {for_days:g} days")
        return made
    finally:
        engine.dispose()


async def _served(request: ServeRequest, service: Service, listening: socket.socket, post: StopPost) -> None:
    host, port = listening.getsockname()[:2]
    server = _Server(_config(request, service, post))
    service.tell_stop_post()
    posting = asyncio.create_task(post.work())
    if not await post.until_up(_STOP_POST_WITHIN_S):
        logger.error("the stop post is not available yet; until then stops need the API")
    tasks = [
        asyncio.create_task(going_on(lambda: in_turns(service.queue.work()))),
        asyncio.create_task(going_on(lambda: in_turns(service.live_hub.follow(lambda: service.closing)))),
        asyncio.create_task(server.serve(sockets=[listening])),
    ]
    besides = [
        asyncio.create_task(going_on(lambda: in_turns(service.deferred_audit.work(lambda: service.closing)))),
        asyncio.create_task(going_on(lambda: in_turns(service.watch_database()))),
        asyncio.create_task(going_on(lambda: in_turns(service.owners.follow(lambda: service.closing)))),
    ]
    besides.append(asyncio.create_task(going_on(lambda: in_turns(_durations_of(service)))))
    speeds = HeardSpeeds(service)
    besides.append(asyncio.create_task(going_on(lambda: in_turns(speeds.work(lambda: service.closing)))))
    if request.notices is not None:
        watch = NoticeWatch(service, Post(request.folder, request.notices))
        besides.append(asyncio.create_task(going_on(lambda: in_turns(watch.work()))))
    service.campaigns.go_on()
    service.recordings.go_on()
    besides.append(asyncio.create_task(going_on(lambda: in_turns(service.sharing.work()))))
    if (keeper := service.keeper) is not None:
        besides.append(asyncio.create_task(going_on(lambda: in_turns(keeper.work()))))
    try:
        while not server.started and not tasks[2].done():
            await asyncio.sleep(0.01)
        listening.listen(_BACKLOG)  # more may wait than are taken at once
        shown = f"[{host}]" if ":" in host else host
        request.ready(f"http://{shown}:{port}")
        until_s = time.monotonic() + request.for_s
        ended = False
        while not (ended or request.stop.times or time.monotonic() > until_s):
            ended = any(task.done() for task in (*tasks, *besides))
            await asyncio.sleep(_LOOK_S)
        await service.queue.close(lambda: request.stop.times > 1)
    finally:
        for task in besides:
            task.cancel()  # what is on its way to the store is brought there again
        service.closing = True
        server.should_exit = True
        await service.studies.close()
        await service.campaigns.close()
        await service.recordings.close()
        service.worker_pool.close()
        service.drawing.close()
        service.clouds.close()
        service.viewing.close()
        service.upload_reader.close()
        for bench in list(service.benches):
            service.changed(bench)
            service.agents.wake(bench)
    done, _ = await asyncio.wait([*tasks, *besides], timeout=_LAST_ANSWERS_S + 3.0)
    post.close()
    await asyncio.wait([posting], timeout=_LAST_ANSWERS_S)
    for task in done:
        if not task.cancelled():
            task.result()  # a mistake of ours in one of them is reported
    await in_turns(service.leave())


async def _durations_of(service: Service) -> None:
    found = service.queue_forecast

    def present() -> list[RunData]:
        found.show_reservations()
        return found.present_runs()

    await service.durations.work(present, found.predicted_s, service.changed, lambda: service.closing)


def _config(request: ServeRequest, service: Service, post: StopPost) -> uvicorn.Config:
    guard = Guarding(
        _names(request),
        Rates(request.rate, _AT_ONCE_S * request.rate),
        StopAddress(post.port, request.stop_url),
        frozenset(request.trusted_proxies),
    )
    return uvicorn.Config(
        application(service, guard),
        http=bounded(frozenset(request.trusted_proxies)),
        ws="none",
        log_config=None,
        access_log=False,
        lifespan="off",
        server_header=False,
        proxy_headers=bool(request.trusted_proxies),
        forwarded_allow_ips=list(request.trusted_proxies),
        timeout_graceful_shutdown=_LAST_ANSWERS_S,
        h11_max_incomplete_event_size=1 << 16,
        backlog=_TAKEN_AT_ONCE,
    )


def _names(request: ServeRequest) -> tuple[str, ...]:
    return (*_THIS_MACHINE, request.host, *request.hosts)


def _stop_port(request: ServeRequest) -> int:
    if request.stop_port is not None:
        return request.stop_port
    return request.port + 1 if request.port else 0


class _Server(uvicorn.Server):
    """Signals are heard by the command, which ends runs before it ends the server."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave them alone."""
        yield


def _place_of(folder: Path) -> str:
    return f"that of {socket.gethostname()}:{folder.resolve()}"


def _database(folder: Path, url: str, locked_s: float = 10.0) -> Engine:
    return open_database(url or f"sqlite:///{folder.resolve() / 'service.sqlite'}", locked_s)


def _refuse_open_to_all(host: str, tokens: TokenStore) -> None:
    """Who can be reached from other machines has to know who asks."""
    try:
        loopback = host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        loopback = False
    if not loopback and not tokens.any():
        raise BadInputError(
            "there is no token yet, so anyone who reaches this address could drive the benches",
            where=f"--host {printable(host)}",
            fix="make one first: hil serve --data DIR --add-token NAME=admin; or give --sign-in FILE; "
            "or leave --host out",
        )


@contextlib.contextmanager
def _listening(host: str, port: int, option: str) -> Iterator[socket.socket]:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listening = socket.create_server((host, port), family=family, backlog=_BACKLOG)
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise BenchError(
            f"the service cannot listen there: {reason}",
            where=f"{printable(host)}:{port}",
            fix=f"check for another service; give another port with {option}, or 0 for a free one",
        ) from error
    with listening:
        yield listening
