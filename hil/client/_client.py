"""What can be asked of a bench service, with the types that the service itself uses."""

from __future__ import annotations

import time
import urllib.parse
from collections.abc import Iterator, Mapping
from pathlib import Path

from hil.api_schemas.agent import (
    AgentData,
    AgentOrders,
    AgentReport,
    AgentsForecast,
    Delivered,
    FileThere,
    RunEnding,
    Taken,
)
from hil.api_schemas.api import (
    OVER,
    Answer,
    AuditEntry,
    BenchData,
    ForecastData,
    ForecastWanted,
    Health,
    LeaseData,
    LeaseWanted,
    Me,
    PlanData,
    Role,
    RunChange,
    RunData,
    RunWanted,
    TokenData,
    TokenMade,
    TokenWanted,
    TrendData,
)
from hil.api_schemas.campaign import CampaignData, CampaignExample, CampaignFindings, CampaignWanted
from hil.api_schemas.comparison import ComparisonData, TracesData
from hil.api_schemas.design import (
    CloudData,
    CloudWanted,
    ControllerData,
    DesignData,
    DraftData,
    DraftWanted,
    ModelData,
    PlanCopyWanted,
    SegmentsData,
    SegmentsWanted,
)
from hil.api_schemas.notes import NoteData, NoteWanted, RunNotes
from hil.api_schemas.run_list import FoundRuns, RunsWanted
from hil.api_schemas.study import (
    DiagnosisData,
    DiagnosisWanted,
    IdentificationData,
    IdentificationWanted,
    StudyData,
)
from hil.api_schemas.upload import KeptApart
from hil.client._requests import WITHIN_S, Requests, first_of, part
from hil.core.errors import BenchError

_FORECAST_WITHIN_S = 300.0
_REPORTED_WITHIN_S = 5.0
_LOOK_S = 0.5


class Client(Requests):
    """A bench service.

    Every method raises RefusedError if the service refuses, and BenchError if it cannot be reached or does
    not answer as one.

    Args:
        url: where it is, as `hil serve` says: `http://127.0.0.1:8080`.
        token: who asks; a service without tokens asks no one.
    """

    _stop_url = ""

    def health(self) -> Health:
        """Whether it works."""
        return self._one(Health, "GET", "/health")

    def me(self) -> Me:
        """Who asks, and what they may do."""
        return self._one(Me, "GET", "/me")

    def benches(self) -> list[BenchData]:
        """All benches and what they do."""
        return self._several(BenchData, "/benches")

    def bench(self, bench: str) -> BenchData:
        """A bench and what it does."""
        return self._one(BenchData, "GET", f"/benches/{part(bench)}")

    def find_stop_post(self) -> str:
        """Where the service takes emergency stops whatever else it does; '' if it does not say so.

        Who may have to stop a bench asks beforehand: a service that is flooded answers late.
        """
        self._stop_url = self.health().stop_url
        return self._stop_url

    def stop_in_emergency(self, bench: str) -> None:
        """Have a bench safe at once, and keep it so until it is reset.

        The stop post and the API are asked at the same moment; the first that has taken it is enough.
        """
        path = f"/benches/{part(bench)}/emergency-stop"
        first_of([lambda: self._post_to_stop_post(path), lambda: self._done("POST", path)], WITHIN_S)

    def _post_to_stop_post(self, path: str) -> None:
        url = self._stop_url or self.find_stop_post()
        if not url:
            raise BenchError("the service has no stop post", where=self._url)
        with Requests(url, self._token)._opened("POST", path, None, WITHIN_S):
            pass

    def reset(self, bench: str) -> BenchData:
        """Let a bench be armed again after an emergency stop."""
        return self._one(BenchData, "POST", f"/benches/{part(bench)}/reset")

    def lease(self, bench: str, for_s: float = 60.0) -> LeaseData:
        """Have a bench for oneself for a while; call it again before it is over to go on."""
        return self._one(LeaseData, "PUT", f"/benches/{part(bench)}/lease", LeaseWanted(for_s=for_s))

    def give_back(self, bench: str) -> BenchData:
        """Give a bench back."""
        return self._one(BenchData, "DELETE", f"/benches/{part(bench)}/lease")

    def plans(self) -> list[PlanData]:
        """All plans."""
        return self._several(PlanData, "/plans")

    def give_plan(self, name: str, text: str) -> PlanData:
        """Give a plan (YAML), or replace one that was given."""
        return self._one(PlanData, "PUT", f"/plans/{part(name)}", text)

    def kept_apart(self) -> list[KeptApart]:
        """Files of an earlier version's folder that the service has kept as they are, and does not share."""
        return self._several(KeptApart, "/kept-apart")

    def forecast(self, plan: str, bench: str, values: Mapping[str, float] | None = None) -> ForecastData:
        """Duration, peaks and criteria as predicted."""
        wanted = ForecastWanted(plan=plan, bench=bench, values=dict(values or {}))
        return self._one(ForecastData, "POST", "/forecasts", wanted, within_s=_FORECAST_WITHIN_S)

    def runs(self, bench: str | None = None, most: int = 50) -> list[RunData]:
        """Runs, newest first."""
        query = {"most": str(most)} | ({"bench": bench} if bench else {})
        return self._several(RunData, f"/runs?{urllib.parse.urlencode(query)}")

    def find_runs(self, wanted: RunsWanted) -> FoundRuns:
        """A page of all runs that pass the filters, sorted by the service."""
        chosen = wanted.model_dump(mode="json", exclude_defaults=True)
        query = urllib.parse.urlencode(chosen, doseq=True)
        return self._one(FoundRuns, "GET", f"/run-list?{query}")

    def trends(self, bench: str, plan: str) -> list[TrendData]:
        """Each criterion of a plan on a bench over its newest runs."""
        return self._several(TrendData, f"/trends?{urllib.parse.urlencode({'bench': bench, 'plan': plan})}")

    def run(self, run: int) -> RunData:
        """A run."""
        return self._one(RunData, "GET", f"/runs/{run}")

    def notes(self, run: int) -> RunNotes:
        """Notes and tags that people have added to a run."""
        return self._one(RunNotes, "GET", f"/runs/{run}/notes")

    def add_note(self, run: int, text: str) -> NoteData:
        """Add a note to a run."""
        return self._one(NoteData, "POST", f"/runs/{run}/notes", NoteWanted(text=text))

    def tag(self, run: int, tag: str) -> None:
        """Have a run found by a tag."""
        self._done("PUT", f"/runs/{run}/tags/{part(tag)}")

    def queue(self, wanted: RunWanted) -> RunData:
        """Queue a run; with a key, a repeated request queues no second."""
        return self._one(RunData, "POST", "/runs", wanted)

    def set_priority(self, run: int, priority: int) -> RunData:
        """Change the place of a run in its queue."""
        return self._one(RunData, "PATCH", f"/runs/{run}", RunChange(priority=priority))

    def approve(self, run: int) -> RunData:
        """Approve a run of a hazardous plan that somebody else wants."""
        return self._one(RunData, "POST", f"/runs/{run}/approve")

    def pause(self, run: int) -> RunData:
        """Hold a run at its next safe point."""
        return self._one(RunData, "POST", f"/runs/{run}/pause")

    def resume(self, run: int) -> RunData:
        """Let a run go on that is held."""
        return self._one(RunData, "POST", f"/runs/{run}/resume")

    def answer(self, run: int, text: str) -> RunData:
        """Answer the operator's prompt of a run."""
        return self._one(RunData, "POST", f"/runs/{run}/answer", Answer(text=text))

    def abort(self, run: int) -> RunData:
        """End a run that is under way with its end steps, or cancel one that waits."""
        return self._one(RunData, "POST", f"/runs/{run}/abort")

    def progress(self, run: int) -> Iterator[RunData]:
        """The run every half second, until it is over; the last time as it ended."""
        while True:
            found = self.run(run)
            yield found
            if found.state in OVER:
                return
            time.sleep(_LOOK_S)

    def comparison(self, first: int, other: int) -> ComparisonData:
        """Two runs of one plan side by side."""
        query = f"first={first}&other={other}"
        return self._one(ComparisonData, "GET", f"/comparisons?{query}", within_s=_FORECAST_WITHIN_S)

    def traces(
        self,
        first: int,
        other: int,
        segment: str,
        channel: str,
        *,
        within_s: tuple[float, float] | None = None,
        most: int = 600,
    ) -> TracesData:
        """A channel of a segment of two runs, in `most` buckets; `within_s` of the step, or the whole."""
        asked: dict[str, object] = {"first": first, "other": other, "segment": segment, "channel": channel}
        asked |= {"most": most}
        if within_s is not None:
            asked |= {"start_s": within_s[0], "end_s": within_s[1]}
        query = urllib.parse.urlencode(asked)
        return self._one(TracesData, "GET", f"/comparisons/traces?{query}", within_s=_FORECAST_WITHIN_S)

    def models(self) -> list[ModelData]:
        """All models."""
        return self._several(ModelData, "/models")

    def give_model(self, name: str, text: str) -> ModelData:
        """Give a model file."""
        return self._one(ModelData, "PUT", f"/models/{part(name)}", text)

    def controllers(self) -> list[ControllerData]:
        """All controllers."""
        return self._several(ControllerData, "/controllers")

    def give_controller(self, name: str, text: str) -> ControllerData:
        """Give a controller file, so that plans can load it."""
        return self._one(ControllerData, "PUT", f"/controllers/{part(name)}", text)

    def give_picture(self, name: str, content: bytes) -> None:
        """Give a picture, so that prompts of plans can show it."""
        with self._opened("PUT", f"/pictures/{part(name)}", content, WITHIN_S):
            pass

    def copy_plan(self, plan: str, wanted: PlanCopyWanted) -> PlanData:
        """Give a copy of a plan that loads other controllers."""
        return self._one(PlanData, "POST", f"/plans/{part(plan)}/copies", wanted)

    def draft(self, wanted: DraftWanted) -> DraftData:
        """Loops, margins and steps of a controller on a model."""
        return self._one(DraftData, "POST", "/drafts", wanted, within_s=_FORECAST_WITHIN_S)

    def draft_cloud(self, wanted: CloudWanted) -> CloudData:
        """A draft on cars drawn around its model."""
        return self._one(CloudData, "POST", "/drafts/clouds", wanted, within_s=_FORECAST_WITHIN_S)

    def draft_segments(self, wanted: SegmentsWanted) -> SegmentsData:
        """Margins of a plan's controllers and of a draft in each segment."""
        return self._one(SegmentsData, "POST", "/drafts/segments", wanted, within_s=_FORECAST_WITHIN_S)

    def design(self, wanted: DraftWanted) -> DesignData:
        """A controller's file, judged on every plant that the model's uncertainty allows."""
        return self._one(DesignData, "POST", "/designs", wanted, within_s=_FORECAST_WITHIN_S)

    def identify(self, wanted: IdentificationWanted) -> StudyData:
        """Have a model identified from runs; `study` tells how it goes."""
        return self._one(StudyData, "POST", "/identifications", wanted)

    def diagnose(self, wanted: DiagnosisWanted) -> StudyData:
        """Have it found out why runs and a model differ; `study` tells how it goes."""
        return self._one(StudyData, "POST", "/diagnoses", wanted)

    def studies(self) -> list[StudyData]:
        """Identifications and diagnoses, newest first."""
        return self._several(StudyData, "/studies")

    def study(self, study: int) -> StudyData:
        """An identification or a diagnosis."""
        return self._one(StudyData, "GET", f"/studies/{study}")

    def cancel_study(self, study: int) -> StudyData:
        """End one; a diagnosis writes what it knows by then."""
        return self._one(StudyData, "POST", f"/studies/{study}/cancel")

    def remove_study(self, study: int) -> None:
        """Remove one that is over, with its files."""
        self._done("DELETE", f"/studies/{study}")

    def identification(self, study: int) -> IdentificationData:
        """What an identification found."""
        path = f"/identifications/{study}"
        return self._one(IdentificationData, "GET", path, within_s=_FORECAST_WITHIN_S)

    def diagnosis(self, study: int) -> DiagnosisData:
        """What a diagnosis found."""
        return self._one(DiagnosisData, "GET", f"/diagnoses/{study}")

    def campaign_examples(self) -> list[CampaignExample]:
        """The built-in campaigns."""
        return self._several(CampaignExample, "/campaign-examples")

    def add_campaign(self, wanted: CampaignWanted) -> CampaignData:
        """Have a campaign executed; `campaign` tells how it goes."""
        return self._one(CampaignData, "POST", "/campaigns", wanted, within_s=_FORECAST_WITHIN_S)

    def campaigns(self) -> list[CampaignData]:
        """Campaigns, newest first."""
        return self._several(CampaignData, "/campaigns")

    def campaign(self, campaign: int) -> CampaignData:
        """A campaign, with its progress and the shares that pass so far."""
        return self._one(CampaignData, "GET", f"/campaigns/{campaign}")

    def campaign_findings(self, campaign: int) -> CampaignFindings:
        """What a campaign that is over came to."""
        return self._one(CampaignFindings, "GET", f"/campaigns/{campaign}/findings")

    def cancel_campaign(self, campaign: int) -> CampaignData:
        """End one; what is under way is awaited and kept, unless this is asked twice."""
        return self._one(CampaignData, "POST", f"/campaigns/{campaign}/cancel")

    def resume_campaign(self, campaign: int) -> CampaignData:
        """Go on with one that was cancelled or has failed."""
        return self._one(CampaignData, "POST", f"/campaigns/{campaign}/resume")

    def remove_campaign(self, campaign: int) -> None:
        """Remove one that is over, with its files."""
        self._done("DELETE", f"/campaigns/{campaign}")

    def download_of_campaign(self, campaign: int, name: str, path: Path) -> None:
        """Write a file of a campaign, whole or not at all.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/campaigns/{campaign}/files/{part(name)}", path)

    def download(self, run: int, name: str, path: Path) -> None:
        """Write a file of a run, whole or not at all.

        Raises:
            BadInputError: the place cannot be written.
        """
        self._download(f"/runs/{run}/files/{part(name)}", path)

    def agents(self) -> list[AgentData]:
        """Agents that have benches there."""
        return self._several(AgentData, "/agents")

    def let_agent_go(self, bench: str) -> None:
        """Let another agent have the bench of one that is away."""
        self._done("DELETE", f"/benches/{part(bench)}/agent")

    def report(self, agent: str, report: AgentReport) -> AgentOrders:
        """What an agent tells of itself, and what it has to do."""
        return self._one(AgentOrders, "PUT", f"/agents/{agent}", report, within_s=_REPORTED_WITHIN_S)

    def take(self, agent: str, bench: str) -> Taken:
        """The run whose turn it is on a bench of an agent."""
        return self._one(Taken, "POST", f"/agents/{agent}/benches/{part(bench)}/take")

    def send(self, agent: str, run: int, name: str, at: int, piece: bytes) -> FileThere:
        """A piece of a file of an agent's run; how much of it is there then."""
        return self._one(FileThere, "PUT", f"/agents/{agent}/runs/{run}/files/{part(name)}?at={at}", piece)

    def answer_forecast(self, agent: str, order: str, answer: AgentsForecast) -> None:
        """What an agent predicts of a plan that it was asked about."""
        with self._opened("PUT", f"/agents/{agent}/forecasts/{order}", answer, WITHIN_S):
            pass

    def deliver(self, agent: str, run: int, ending: RunEnding) -> Delivered:
        """How an agent's run ended; which of its files are to be sent before it is over there."""
        return self._one(
            Delivered, "POST", f"/agents/{agent}/runs/{run}/ending", ending, within_s=_FORECAST_WITHIN_S
        )

    def tokens(self) -> list[TokenData]:
        """All tokens, without their secrets."""
        return self._several(TokenData, "/tokens")

    def make_token(self, name: str, role: Role, for_days: float = 365.0) -> TokenMade:
        """Make a token that is valid for so many days; its secret is reported this once."""
        return self._one(TokenMade, "POST", "/tokens", TokenWanted(name=name, role=role, for_days=for_days))

    def audit(self, most: int = 100) -> list[AuditEntry]:
        """What was done by whom, newest first."""
        return self._several(AuditEntry, f"/audit?most={most}")
