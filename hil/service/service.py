"""The service as a whole: benches, plans, queue, runs and who asks for them."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from sqlalchemy import Engine

from hil.api_schemas.api import (
    OVER,
    BenchData,
    BenchState,
    ForecastData,
    LeaseData,
    Me,
    ReservationData,
    RunData,
    RunState,
)
from hil.api_schemas.campaign import CampaignData
from hil.api_schemas.recording import RecordingData
from hil.api_schemas.study import StudyData
from hil.execution.background import apart
from hil.execution.benches import Bench
from hil.execution.data_folder import files_in
from hil.execution.forecasts import Forecasts
from hil.execution.run_execution import RunningRun
from hil.service.agents.agents import Agents
from hil.service.agents.agents_forecasts import AgentsForecasts
from hil.service.agents.remote_bench import RemoteBench
from hil.service.agents.run_upload import RunUploads
from hil.service.archive import Archive, Keeper, Rounds
from hil.service.audit import DeferredAudit, problem_of
from hil.service.durations import Durations
from hil.service.files.catalogues import bench_catalogue, controller_catalogue, model_catalogue
from hil.service.files.legacy_import import LegacyImport
from hil.service.files.pictures import Pictures
from hil.service.files.plans import Plans
from hil.service.files.served_benches import ServedBenches
from hil.service.files.upload_reader import UploadReader
from hil.service.files.uploads import NameTakenError, Uploads
from hil.service.jobs.campaigns import Campaigns, Places, Simulating
from hil.service.jobs.shared_results import SharedResults
from hil.service.jobs.studies import Studies
from hil.service.live.live_hub import LiveHub
from hil.service.owners import OwnersKnown
from hil.service.queue import Queue
from hil.service.queue_forecast import QueueForecast
from hil.service.recordings import GivenRecordings, Room
from hil.service.sign_in import SignIn
from hil.service.stop_post import OwnBench, StopPost
from hil.service.stops import Stops
from hil.service.store import (
    BenchStore,
    DatabaseAwayError,
    DurationStore,
    FileStore,
    GivenStore,
    HandoverStore,
    LayoutStore,
    LeaseStore,
    LogStore,
    NoteStore,
    PersonStore,
    Presence,
    ReservationStore,
    ResultStore,
    RunList,
    RunStore,
    TokenStore,
    VersionStore,
)
from hil.service.turns import Turns
from hil.service.worker_pool import WorkerPool
from test_plans import Plan

_VIEW_S = 600.0
_ASK_S = 1.0  # a database that is away
_MOST_SHOWN = 100
_LAST = 2**31 - 1
_OPEN: tuple[RunState, ...] = ("queued", "waiting_approval", "running")

logger = logging.getLogger(__name__)


@dataclass
class Waiting:
    """What the store has of a bench: runs that wait, in their order, how many they are, and whose it is."""

    runs: list[RunData] = field(default_factory=list)
    count: int = 0
    lease: LeaseData | None = None
    reservation: ReservationData | None = None


class Service:
    """Everything that the API needs. All of it is used from one event loop, and nothing in it waits.

    Args:
        folder: where everything is kept.
        held: the benches that it drives, for other services of the same database.
        archive: where files are kept for good; None keeps them in the folder.
        local_days: how long files that the archive has stay in the folder.
        stop_post: takes emergency stops whatever becomes of this.
        sign_in: signs people in by OpenID Connect; None: there are tokens only.
        room: for recordings that people give.

    Raises:
        BenchError: another service drives one of the benches, or the database is away.
    """

    def __init__(
        self,
        folder: Path,
        engine: Engine,
        held: BenchStore,
        benches: dict[str, Bench],
        simulating: Simulating,
        archive: Archive | None = None,
        local_days: float = 30.0,
        stop_post: StopPost | None = None,
        sign_in: SignIn | None = None,
        room: Room | None = None,
    ) -> None:
        self.served_benches = ServedBenches(folder / "benches", folder.resolve())
        given_benches = self.served_benches.there(lambda name: _refused(name, benches, held))
        benches = {**benches, **given_benches}
        self._own, self.folder = benches, folder
        self.database = Presence(engine)
        self.runs, self.run_list, self.leases = RunStore(engine), RunList(engine), LeaseStore(engine)
        self.reservations, self.handovers = ReservationStore(engine), HandoverStore(engine)
        self.durations = Durations(DurationStore(engine))
        self.turns = Turns(self.runs, self.leases, self.reservations, self.durations)
        self.queue_forecast = QueueForecast(self)
        self.layouts, self.notes = LayoutStore(engine), NoteStore(engine)
        self.tokens, self.log = TokenStore(engine), LogStore(engine)
        self.people, self.sign_in = PersonStore(engine), sign_in
        self._open_given(GivenStore(engine))
        self.versions = VersionStore(engine)
        self.forecasts = Forecasts()
        results, elsewhere = ResultStore(engine, held.service, held.place), folder / "elsewhere"
        studies = SharedResults(results, "study", StudyData, archive, elsewhere / "studies")
        campaigns = SharedResults(results, "campaign", CampaignData, archive, elsewhere / "campaigns")
        self.studies = Studies(folder / "studies", studies)
        recordings = SharedResults(results, "recording", RecordingData, archive, elsewhere / "recordings")
        self.recordings = GivenRecordings(folder / "recordings", recordings, room)
        # One worker reads recordings, so that a design in the other does not wait.
        self.worker_pool, self.drawing = WorkerPool(niceness=10), WorkerPool(niceness=0)
        # Cars around a draft take a second: whoever moves a slider meanwhile does not wait for them.
        self.clouds = WorkerPool(niceness=5)
        # And one looks at runs: an hour that no one followed takes it ten seconds, once.
        self.viewing = WorkerPool(niceness=5, within_s=_VIEW_S)
        self.upload_reader = UploadReader(self.plans)
        self.campaigns = Campaigns(folder / "campaigns", simulating, self.worker_pool, campaigns)
        self.sharing = Rounds(self._share, "files of studies, campaigns and recordings")
        self._held = held
        self.live_hub = LiveHub(lambda: self.benches, self.running, folder / "overviews")
        runs_folder = folder / "runs"
        self.keeper: Keeper | None = None
        if archive is not None:
            files = FileStore(engine)
            self.keeper = Keeper(archive, files, held.service, runs_folder, self.live_hub.runs, local_days)
        source, changed = self.plans.source, self.live_hub.changed
        self.queue = Queue(benches, self.runs, self.turns, held, runs_folder, source, changed, stop_post)
        self.owners = OwnersKnown((self.tokens, self.people), stop_post)
        self.stops = Stops(self, stop_post)
        self.began_s = time.monotonic()
        self.closing = False
        self._waiting: defaultdict[str, Waiting] = defaultdict(Waiting)
        self.agents = Agents(engine, held.service, self.runs, self.turns, runs_folder, source, changed)
        self.agents_forecasts = AgentsForecasts()
        self.run_uploads = RunUploads(held.service, self.runs, runs_folder)
        self.audit_problem = ""
        self.known_agents: dict[str, Me] = {}  # by secret, for while the database is away
        self.deferred_audit = DeferredAudit(self.log)

    def _open_given(self, given: GivenStore) -> None:
        """Plans, controllers, models, bench files and pictures that people gave."""
        folder = self.folder
        models = Uploads(given, "model", folder / "given/models", ".toml")
        controllers = Uploads(given, "controller", folder / "given/plans", ".toml")
        self.pictures = Pictures(given, folder / "given/plans")
        self.plans = Plans(
            Uploads(given, "plan", folder / "given/plans", ".yaml"), controllers, self.pictures
        )
        self.bench_files = bench_catalogue(Uploads(given, "bench", folder / "given/benches", ".toml"))
        self.models, self.controllers = model_catalogue(models), controller_catalogue(controllers)
        earlier = LegacyImport(folder, given, self.log, self.plans, self.controllers, self.models)
        self.kept_apart = earlier.take_in()

    async def _share(self) -> str:
        problems = await self.studies.share(), await self.campaigns.share(), await self.recordings.share()
        return "; ".join(filter(None, problems))

    @property
    def benches(self) -> Mapping[str, Bench | RemoteBench]:
        """The service's own, then those of agents."""
        return {**self._own, **{n: b for n, b in self.agents.benches.items() if n not in self._own}}

    def own(self, bench: str) -> Bench | None:
        """A bench of the service's own; None if it is an agent's."""
        return self._own.get(bench)

    def serve_bench(self, name: str, text: str) -> None:
        """Serve a simulated bench that somebody gave.

        Raises:
            BadInputError: it cannot be served, or there is a bench of its name.
            BenchError: another service drives one of its name.
        """
        if name in self.benches:
            raise NameTakenError("there is a bench of this name", where=name, fix="give it another name")
        bench = self.served_benches.add(name, text, self.models.paths())
        try:
            self.queue.add(bench)
        except BaseException:
            self.served_benches.remove(name)
            raise
        self._own[name] = bench
        self.tell_stop_post()
        self.changed(name)

    def drop_bench(self, name: str) -> bool:
        """Serve a bench that somebody gave no longer; false while runs wait or are under way there."""
        open_ones = self.runs.all(bench=name, states=_OPEN, before=_LAST, most=1)
        if open_ones or not self.queue.drop(name):  # one that just begins is nowhere but in the database
            return False
        del self._own[name]
        self.served_benches.remove(name)
        self.tell_stop_post()
        self._held.give_back(name)
        return True

    def running(self, bench: str) -> RunningRun | None:
        """The run under way on a bench."""
        return self.queue.running(bench) if self._is_own(bench) else self.agents.benches[bench].running

    def running_run(self, run: int) -> RunningRun | None:
        """A run by its number, if it is under way."""
        return self.queue.running_run(run) or self.agents.running_run(run)

    def state(self, bench: str) -> tuple[BenchState, str]:
        """What a bench does, and why it may not be driven."""
        return self.queue.state(bench) if self._is_own(bench) else self.agents.benches[bench].state()

    def _is_own(self, bench: str) -> bool:
        """Whether it is the service's own, or was until a moment ago."""
        return bench in self._own or bench not in self.agents.benches

    def wake(self, bench: str) -> None:
        """Look now what waits for a bench."""
        if bench in self._own:
            self.queue.wake()
        self.agents.wake(bench)

    def changed(self, bench: str) -> None:
        """Something of a bench is to be shown anew."""
        self.live_hub.changed(bench)

    def bench_data(self, name: str, *, ask: bool = True) -> BenchData:
        """A bench as it is now; what waits for it, without asking the database, as it was known last."""
        bench, running = self.benches[name], self.running(name)
        waiting = self.waiting(name) if ask else self._waiting[name]
        state, why = self.state(name)
        agent = bench.agent if isinstance(bench, RemoteBench) else None
        why = f"{why}; {self.database.away}".removeprefix("; ") if self.database.away else why
        return BenchData(
            name=name,
            title=bench.title,
            simulated=bench.simulated,
            state=state,
            why=why,
            running=running.data.id if running else None,
            waiting=waiting.count,
            limits=bench.limits,
            units=bench.units,
            lease=waiting.lease.holder if waiting.lease else "",
            lease_until=waiting.lease.until if waiting.lease else None,
            reserved_by=waiting.reservation.who if waiting.reservation else "",
            reserved_until=waiting.reservation.ends if waiting.reservation else None,
            machine=agent.machine if agent else "",
            stop_confirmed=not (isinstance(bench, RemoteBench) and bench.stop_by),
            away_since=agent.heard_at if agent and agent.away else None,
            last_speed=self.live_hub.last_speed(name) if state == "emergency_stop" else None,
            speed_unknown=self.live_hub.why_no_speed(name),
        )

    def waiting(self, bench: str) -> Waiting:
        """What waits for a bench; as it was last known while the database is away."""
        with contextlib.suppress(DatabaseAwayError):
            lease = self.leases.of(bench)
            found = self.runs.all(
                bench=bench, states=("queued", "waiting_approval"), before=_LAST, most=_MOST_SHOWN
            )
            found.sort(key=lambda run: (-run.priority, run.id))
            found = self.queue_forecast.of_queue(bench, found)
            reserved = self.queue_forecast.reservation(bench)
            self._waiting[bench] = Waiting(found, self.runs.waiting(bench), lease, reserved)
        return self._waiting[bench]

    def with_progress(self, run: RunData) -> RunData:
        """A run with what only this process knows: how far it is, which files it has left."""
        if run.state in OVER:  # first: a run that has just ended may still stand among the running ones
            return run.model_copy(update={"files": self.files_of(run.id)})
        running = self.running_run(run.id)
        if running is not None:
            away = f"; {self.database.away}" if self.database.away else ""
            doing = {"share": running.share, "doing": running.shown + away, "message": running.message}
            return run.model_copy(update={**doing, "prompt": running.prompt})
        return run

    def files_of(self, run: int) -> list[str]:
        """Names of the files that a run has left."""
        here = {path.name for path in files_in(self.queue.folder_of(run))}
        return sorted(here.union(self.keeper.names(run) if self.keeper else ()))

    async def file_of(self, run: int, name: str) -> Path:
        """A file of a run, brought here from the archive if it is not here any more.

        Raises:
            BenchError: the archive does not give it.
        """
        if self.keeper is not None:
            return await self.keeper.bring_back(run, name)
        return self.queue.folder_of(run) / name

    def places(self) -> Places:
        """What a campaign may name."""
        here = {name: one.file.source for name, one in self.benches.items() if isinstance(one, Bench)}
        return Places(self.plans.fresh_folder(), self.models.paths(), here)

    async def forecast(self, plan: Plan, bench: str) -> ForecastData:
        """Duration, peaks and criteria as predicted where the bench is.

        Raises:
            BadInputError: the plan asks for more than the bench allows.
            BenchError: it cannot be predicted.
        """
        own = self.own(bench)
        if own is not None:
            return await self.forecasts.of(plan, own.file)
        return await self.agents_forecasts.of(plan, self.agents.benches[bench])

    async def reset(self, bench: str, by: str) -> int | None:
        """Let a bench be armed again; how many stops there were, None if its agent has not answered.

        Raises:
            HilError: that cannot be written.
        """
        own = self.own(bench)
        self.stops.reset(bench)
        if own is not None:
            return own.reset(by)
        return 1 if await self.agents.reset(bench, by) else None

    async def watch_database(self) -> None:
        """Ask a database that is away whether it is back, until the service is closed."""
        shown = ""
        self.audit_problem = await apart(partial(problem_of, self.log, self.folder))
        while not self.closing:
            await asyncio.sleep(_ASK_S)
            self.agents.look()
            self.tell_stop_post()
            if self.database.away:
                await apart(self.database.ask)
                self.queue.wake()
            if self.database.away != shown:
                shown = self.database.away
                for bench in self.benches:
                    self.changed(bench)

    def tell_stop_post(self) -> None:
        """Have it know all benches that there are."""
        if self.stops.post is not None:
            own = {
                name: OwnBench(file=str(bench.file.source), stops=str(bench.stops or ""))
                for name, bench in self._own.items()
            }
            self.stops.post.know_benches(own, [name for name in self.benches if name not in self._own])

    async def leave(self) -> None:
        """Keep where the audit log ends; let others drive the benches, which are free by themselves later."""
        self.deferred_audit.write()
        with contextlib.suppress(DatabaseAwayError):
            if not self.audit_problem:
                await apart(partial(problem_of, self.log, self.folder))
            self._held.give_back()


def _refused(name: str, benches: Mapping[str, Bench], held: BenchStore) -> str:
    """Why a given bench of a name is not served here; '' if it is."""
    return "the service has a bench of this name" if name in benches else held.hold(name)
