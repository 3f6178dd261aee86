// One bench: what it does, its run as it goes on, its queue, the form that starts a plan, what came last.

import type { JSX } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import type { FoundRuns, Run, RunView } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tx } from "../i18n/text.ts";
import { useLive } from "../live.ts";
import { Board } from "../plot/board.tsx";
import { useMay, useMe } from "../session.ts";
import { useStore } from "../store.ts";
import { Badge, linkTo, Moment, Scroll, Section, verdictOf } from "../ui/parts.tsx";
import { Banner } from "./bench-banner.tsx";
import { Criteria } from "./criteria.tsx";
import { Queue } from "./queue.tsx";
import { limitsOf } from "./runs/failed-limits.ts";
import { detailsOf, titleOf } from "./runs/run-name.ts";
import { StartPlan } from "./plans/start-plan.tsx";
import { Handovers } from "./team/handovers.tsx";
import { Reservations } from "./team/reservations.tsx";
import { Trends } from "./trends/trends.tsx";

const AGAIN_MS = 2000;
const LATEST = 10;

export function BenchView({ bench }: { bench: string }): JSX.Element {
  const live = useLive(bench);
  const state = useStore(live.state);
  const may = useMay(), me = useMe();
  const running = state?.running ?? null;
  return (
    <>
      {state ? <Banner state={state} level={1} /> : <h1>{t("Bench {bench}", { bench })}</h1>}
      <p class="links"><a href={to.panel(bench)}>{t("Operator panel")}</a> <a href={`${to.list("runs")}?bench=${encodeURIComponent(bench)}`}>{t("All runs of this bench")}</a> <a href={to.wall(bench)}>{t("For the wall of a control room")}</a></p>
      {state && me.tokens ? <p class="quiet">{t("On this page now: {names}", { names: state.viewers.join(", ") })}</p> : null}
      {running ? <Running key={running.id} run={running} /> : null}
      <div class="columns">
        <div>
          {running ? <LiveCriteria run={running.id} live={live} /> : null}
          <Handovers bench={bench} />
          <Latest bench={bench} over={`${state?.bench.running ?? ""}`} />
        </div>
        <div>
          <Section title={t("Queue")} label="queue">{state ? <Queue runs={state.queue} /> : null}</Section>
          <Reservations bench={bench} />
          {may("operator") ? <Section title={t("Start a plan")} label="start"><StartPlan bench={bench} /></Section> : null}
        </div>
      </div>
    </>
  );
}

function Running({ run }: { run: Run }): JSX.Element | null {
  const view = useData<RunView>(`/runs/${run.id}/view`, AGAIN_MS);
  const limits = useMemo(() => (view.data ? limitsOf(view.data) : []), [view.data]);
  if (!view.data?.live) return <p class="quiet">{t("Nothing has been measured yet.")}</p>;
  return <Section title={tx("Live <a>run {run}</a>", { a: linkTo(to.run(run.id)), run: run.id })} label="plots"><Board view={view.data} limits={limits} plan={run.plan} bench={run.bench} /></Section>;
}

function LiveCriteria({ run, live }: { run: number; live: ReturnType<typeof useLive> }): JSX.Element {
  const found = useStore(live.criteria);
  return <Section title={t("Criteria decided so far")} label="criteria"><Criteria of={found?.run === run ? found.criteria : []} /></Section>;
}

function Latest({ bench, over }: { bench: string; over: string }): JSX.Element {
  const query = new URLSearchParams([["bench", bench], ["most", String(LATEST)], ...["ended", "interrupted", "cancelled"].map((state) => ["state", state])] as string[][]);
  const found = useData<FoundRuns>(`/run-list?${query}`, AGAIN_MS);
  const runs = found.data?.runs.map(({ run }) => run) ?? [];
  useEffect(() => { if (over) found.again(); }, [over]);
  const ended = runs.find((run) => run.state === "ended");
  return (
    <>
      <Section title={t("Latest runs")} label="latest">
        {runs.length ? (
          <Scroll label={t("Latest runs")}>
            <table>
              <thead><tr><th scope="col" class="number">{t("run")}</th><th scope="col">{t("plan")}</th><th scope="col">{t("verdict")}</th><th scope="col">{t("ended")}</th><th scope="col">{t("by")}</th></tr></thead>
              <tbody>
                {runs.map((run) => (
                  <tr key={run.id}>
                    <td class="number"><a href={to.run(run.id)}>{run.id}</a></td><th scope="row">{titleOf(run)}{detailsOf(run) ? <span class="reason">{detailsOf(run)}</span> : null}{run.reason ? <span class="reason"><English>{run.reason.split("\n")[0]}</English></span> : null}</th>
                    <td><Badge kind={verdictOf(run)} />{run.safe_state === "not_confirmed" ? <span class="bad"> {t("NOT CONFIRMED SAFE")}</span> : null}</td><td><Moment at={run.ended_at} /></td><td>{run.requested_by}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </Scroll>
        ) : <p class="quiet">{t("No run has ended yet.")}</p>}
      </Section>
      {ended ? <Trends bench={bench} plan={ended.plan} key={`${ended.plan} ${ended.id}`} /> : null}
    </>
  );
}
