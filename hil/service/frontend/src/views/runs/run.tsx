// A run, under way and afterwards: one view, over what is measured or over what was recorded.

import type { JSX } from "preact";
import { useMemo } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Bench, Run, RunView as View } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, isMissing, useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t, tx } from "../../i18n/text.ts";
import { useLive } from "../../live.ts";
import { Board } from "../../plot/board.tsx";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { useStopOf } from "../../shell/stop.tsx";
import { useStore } from "../../store.ts";
import { Badge, Facts, Heading, Loaded, Moment, Section, verdictOf } from "../../ui/parts.tsx";
import { Banner, ResetOf } from "../bench-banner.tsx";
import { StoppedBench } from "../stopped-benches.tsx";
import { againWith } from "../plans/start-values.ts";
import { NoneThere } from "../none-there.tsx";
import { Criteria } from "../criteria.tsx";
import { limitsOf } from "./failed-limits.ts";
import { Notes } from "./notes.tsx";
import { isPassed, Outcome } from "./outcome.tsx";
import { look, rangeOfSegment } from "./places.ts";
import { titleOf } from "./run-name.ts";
import { tookOf, valuesOf } from "./run-values.ts";
import { Unsettled } from "./unsettled.tsx";
import { WhyItWaits } from "./waiting.tsx";
import { BestRun } from "./best-run.tsx";
import { Downloads, Evidence, Happenings } from "./run-parts.tsx";

const OVER = ["ended", "interrupted", "cancelled"];
const WAITING = ["queued", "waiting_approval"];
const AGAIN_MS = 2000;

export function RunView({ run: id }: { run: number }): JSX.Element {
  const run = useData<Run>(`/runs/${id}`, AGAIN_MS);
  const name = run.data?.bench ?? "", bench = useData<Bench>(name ? `/benches/${encodeURIComponent(name)}` : null, AGAIN_MS);
  useStopOf(name, !name ? null : isMissing(bench) ? false : bench.loading && !bench.data ? null : true);
  if (isMissing(run)) return <NoneThere kind="run" name={id} />;
  return <Loaded whole of={run} what={t("run {run}", { run: id })}>{(found) => <Found key={found.id} run={found} bench={bench.data} />}</Loaded>;
}

function Found({ run, bench }: { run: Run; bench: Bench | null }): JSX.Element {
  const isLive = run.state === "running", isOver = OVER.includes(run.state);
  const recorded = isOver && (run.files ?? []).includes("recording.mcap");
  // What was seen of a run under way is not its recording. All else stays as it ends: somebody may be typing a note.
  const path = `/runs/${run.id}/view`, ofLive = useData<View>(isLive ? path : null, AGAIN_MS), ofRecording = useData<View>(recorded ? path : null), view = isLive ? ofLive : ofRecording;
  const limits = useMemo(() => (view.data ? limitsOf(view.data) : []), [view.data]);
  const live = useLive(isLive ? run.bench : null);
  const state = useStore(live.state), decided = useStore(live.criteria);
  const criteria = isLive ? (decided?.run === run.id ? decided.criteria : []) : view.data?.criteria ?? [];
  return (
    <>
      <Heading kind={tx("Run {run} on {bench}", { run: run.id, bench: <a href={to.bench(run.bench)}>{run.bench}</a> })}>{titleOf(run)} <Badge kind={verdictOf(run)} /></Heading>
      {isLive && state?.running?.id === run.id ? <Banner state={state} /> : null}
      {WAITING.includes(run.state) ? <WhyItWaits run={run} /> : null}
      {isOver ? <Outcome run={run} view={view.data} /> : null}
      {isOver && bench ? isPassed(run) ? <StoppedBench bench={bench} /> : <ResetOf bench={bench} /> : null}
      {isOver ? <Unsettled run={run} view={view.data} /> : null}
      <RunFacts run={run} />
      <RunActions run={run} />
      {view.data ? (
        <Section title={t("Plots")} label="plots"><Board key={run.state} view={view.data} limits={limits} plan={run.plan} bench={isLive ? run.bench : null} /></Section>
      ) : isLive ? <p class="quiet">{t("Nothing has been measured yet.")}</p> : recorded ? <Loaded of={view} what={t("the recording")}>{() => null}</Loaded> : null}
      {isLive || criteria.length ? <Section title={t("Criteria")} label="criteria"><Criteria of={criteria} onSegment={(segment) => { const range = view.data && rangeOfSegment(view.data, segment); if (range) look(range); }} /></Section> : null}
      {view.data ? <Happenings view={view.data} /> : null}
      <Notes key="notes" run={run.id} />
      {isOver ? <Downloads run={run} /> : null}
      {view.data?.evidence ? <Evidence of={view.data.evidence} /> : null}
    </>
  );
}

function RunFacts({ run }: { run: Run }): JSX.Element {
  const values = valuesOf(run);
  const safe = { confirmed: t("confirmed"), not_confirmed: t("NOT CONFIRMED"), not_needed: t("not needed") };
  return (
    <Facts>
      {([
        [t("plan"), <a href={to.plan(run.plan)}>{run.plan}</a>],
        values ? [t("variables"), values] : null,
        run.dut ? [t("device under test"), run.dut] : null,
        [t("asked for by"), run.requested_by],
        run.approved_by ? [t("approved by"), run.approved_by] : null,
        [t("queued at"), <Moment at={run.queued_at} exact />],
        run.started_at ? [t("began"), <Moment at={run.started_at} exact />] : null,
        run.ended_at ? [t("ended"), <Moment at={run.ended_at} exact />] : null,
        tookOf(run) ? [t("duration"), tookOf(run)] : null,
        run.safe_state ? [t("safe state"), <span class={run.safe_state === "not_confirmed" ? "bad" : ""}>{safe[run.safe_state]}</span>] : null,
        run.reason && !(OVER.includes(run.state) && !isPassed(run)) ? [t("reason"), <English>{run.reason}</English>] : null,
        run.hazard ? [t("hazard"), run.hazard] : null,
      ] as ([string, JSX.Element | string] | null)[]).filter((one) => one !== null)}
    </Facts>
  );
}

function RunActions({ run }: { run: Run }): JSX.Element | null {
  const may = useMay();
  const again = async () => {
    const queued = await attempt(() => post<Run>("/runs", { plan: run.plan, bench: run.bench, values: run.values }));
    if (queued) go(to.run(queued.id));
  };
  const recorded = OVER.includes(run.state) && (run.files ?? []).includes("recording.mcap");
  return (
    <div class="row level">
      {may("operator") && OVER.includes(run.state) ? <button type="button" onClick={() => void again()}>{t("Again")}</button> : null}
      {may("operator") && OVER.includes(run.state) ? <a href={againWith(run)}>{t("Again with other values, bench or controller")}</a> : null}
      {may("operator") && WAITING.includes(run.state) ? <button type="button" onClick={() => void attempt(() => post(`/runs/${run.id}/abort`))}>{t("Cancel")}</button> : null}
      {recorded && may("engineer") ? <a href={`${to.list("diagnoses")}?runs=${run.id}`}>{t("Diagnose")}</a> : null}
      {recorded && may("engineer") ? <a href={`${to.list("identifications")}?runs=${run.id}`}>{t("Identify a model")}</a> : null}
      {run.state === "ended" ? <a href={`${to.list("compare")}?runs=${run.id}`}>{t("Compare with another run")}</a> : null}
      {run.state === "ended" ? <BestRun of={run} /> : null}
      <a href={`${to.list("runs")}?plan=${encodeURIComponent(run.plan)}`}>{t("All runs of this plan")}</a>
    </div>
  );
}
