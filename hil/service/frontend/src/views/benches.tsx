// All benches: what each does, and what waits for it.

import type { JSX } from "preact";
import type { Bench, Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tn, tx } from "../i18n/text.ts";
import { useLost } from "../live.ts";
import { Heading, linkTo, Loaded } from "../ui/parts.tsx";
import { AfterStop } from "./bench-banner.tsx";
import { aboutBench, asOf, lookOf, wordOf } from "./bench-words.ts";
import { EndedBadly } from "./ended-badly.tsx";
import { nameOf } from "./runs/run-name.ts";

const AGAIN_MS = 2000;

export function Benches(): JSX.Element {
  const benches = useData<Bench[]>("/benches", AGAIN_MS);
  return (
    <>
      <Heading>{t("Benches")}</Heading>
      <p class="links"><a href={to.wall()}>{t("For the wall of a control room")}</a></p>
      <Loaded of={benches} what={t("benches")}>
        {(all) => all.length
          ? <ul class="cards">{all.map((bench) => <Card key={bench.name} bench={bench} />)}</ul>
          : <p>{tx("No bench yet. Agents bring them: {command}", { command: <code>hil bench agent --server URL</code> })}</p>}
      </Loaded>
      <EndedBadly />
      <p class="links"><a href={to.list("bench-files")}>{t("Bench files")}</a></p>
    </>
  );
}

function Card({ bench }: { bench: Bench }): JSX.Element {
  const run = useData<Run>(bench.running ? `/runs/${bench.running}` : null, AGAIN_MS).data;
  return (
    <li class={`card bench ${lookOf(bench, null)}`}>
      <h2><a href={to.bench(bench.name)}>{bench.name}</a></h2>
      <p class="quiet">{aboutBench(bench, bench.title)}</p>
      <p class="state">{asOf(useLost(), wordOf(bench, run))}</p>
      {bench.why ? <p><English>{bench.why}</English></p> : null}
      {bench.state === "emergency_stop" ? <AfterStop bench={bench} /> : null}
      {run ? <p>{tx("<a>Run {run}</a>: {plan}, by {person}", { a: linkTo(to.run(run.id)), run: run.id, plan: nameOf(run), person: run.requested_by })}</p> : null}
      {run ? <progress max={1} value={run.share ?? 0} aria-label={t("Progress of run {run}", { run: run.id })} /> : null}
      <p class="quiet">{bench.waiting === 0 ? t("No run waits.") : tn("{count} run waits.", "{count} runs wait.", bench.waiting)} <a href={to.panel(bench.name)} aria-label={t("Operator panel of {bench}", { bench: bench.name })}>{t("Operator panel")}</a></p>
    </li>
  );
}
