// Which view an address shows.

import type { ComponentChildren, JSX } from "preact";
import type { Bench } from "../api/types.ts";
import { to, type Place } from "../addresses.ts";
import { isMissing, useData } from "../data.ts";
import { t } from "../i18n/text.ts";
import { useStopOf } from "../shell/stop.tsx";
import { Heading } from "../ui/parts.tsx";
import { Audit } from "./audit.tsx";
import { BenchView } from "./bench.tsx";
import { Benches } from "./benches.tsx";
import { CampaignView } from "./campaigns/campaign.tsx";
import { Campaigns } from "./campaigns/campaigns.tsx";
import { Compare } from "./compare.tsx";
import { Design } from "./design/design.tsx";
import { BenchFiles, BenchFileView, Controllers, ControllerView, Models, ModelView } from "./given/given.tsx";
import { Glossary } from "./glossary.tsx";
import { NoneThere } from "./none-there.tsx";
import { Panel } from "./panel.tsx";
import { Plans, PlanView } from "./plans/plans.tsx";
import { Recordings, RecordingView } from "./recordings/recordings.tsx";
import { RunView } from "./runs/run.tsx";
import { Runs } from "./runs/runs.tsx";
import { Settings } from "./settings.tsx";
import { Diagnoses, DiagnosisView } from "./studies/diagnoses.tsx";
import { TuningView } from "./tuning/tuning.tsx";
import { Tunings } from "./tuning/tunings.tsx";
import { Wall } from "./wall.tsx";
import { TrendsView } from "./trends/trends-view.tsx";
import { Identifications, IdentificationView } from "./studies/identifications.tsx";

export function View({ place }: { place: Place }): JSX.Element {
  switch (place.view) {
    case "benches": return <Benches />;
    case "bench": return <KnownBench key={place.bench} bench={place.bench}><BenchView bench={place.bench} /></KnownBench>;
    case "panel": return <KnownBench key={place.bench} bench={place.bench}><Panel bench={place.bench} /></KnownBench>;
    case "wall": return <Wall key={place.bench} bench={place.bench} />;
    case "runs": return <Runs />;
    case "run": return <RunView key={place.run} run={place.run} />;
    case "compare": return <Compare />;
    case "trends": return <TrendsView />;
    case "plans": return <Plans />;
    case "plan": return <PlanView key={place.name} name={place.name} />;
    case "models": return <Models />;
    case "model": return <ModelView key={place.name} name={place.name} />;
    case "controllers": return <Controllers />;
    case "controller": return <ControllerView key={place.name} name={place.name} />;
    case "bench-files": return <BenchFiles />;
    case "bench-file": return <BenchFileView key={place.name} name={place.name} />;
    case "design": return <Design />;
    case "recordings": return <Recordings />;
    case "recording": return <RecordingView key={place.id} id={place.id} />;
    case "identifications": return <Identifications />;
    case "identification": return <IdentificationView key={place.id} id={place.id} />;
    case "diagnoses": return <Diagnoses />;
    case "diagnosis": return <DiagnosisView key={place.id} id={place.id} />;
    case "tunings": return <Tunings />;
    case "tuning": return <TuningView key={place.id} id={place.id} />;
    case "campaigns": return <Campaigns />;
    case "campaign": return <CampaignView key={place.id} id={place.id} />;
    case "audit": return <Audit />;
    case "settings": return <Settings />;
    case "glossary": return <Glossary />;
    case "missing": return <Missing path={place.path} />;
  }
}

function Missing({ path }: { path: string }): JSX.Element {
  return (
    <>
      <Heading>{t("No such page")}</Heading>
      <p>{t("There is nothing at {path}.", { path })} <a href={to.list("benches")}>{t("All benches")}</a></p>
    </>
  );
}

// A wrong name is no alarm: only a bench that there is gets a live view and a stop of its own.
function KnownBench({ bench, children }: { bench: string; children: ComponentChildren }): JSX.Element {
  const found = useData<Bench>(`/benches/${encodeURIComponent(bench)}`);
  const missing = isMissing(found);
  useStopOf(bench, missing ? false : found.loading && !found.data ? null : true);
  if (missing) return <NoneThere kind="bench" name={bench} />;
  return found.loading && !found.data ? <p class="quiet">{t("Asking the service …")}</p> : <>{children}</>;
}
