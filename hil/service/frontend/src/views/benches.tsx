// All benches: what each does, and what waits for it.

import type { JSX } from "preact";
import type { Bench, Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { t } from "../i18n/text.ts";
import { Heading, Loaded } from "../ui/parts.tsx";
import { STATES } from "./bench-words.ts";

const AGAIN_MS = 2000;

export function Benches(): JSX.Element {
  const benches = useData<Bench[]>("/benches", AGAIN_MS);
  return (
    <>
      <Heading>Benches</Heading>
      <Loaded of={benches} what="benches">
        {(all) => all.length
          ? <ul class="cards">{all.map((bench) => <Card key={bench.name} bench={bench} />)}</ul>
          : <p>No bench yet. Agents bring them: <code>hil bench agent --server URL</code></p>}
      </Loaded>
      <p class="links"><a href={to.list("bench-files")}>{t("Bench files")}</a></p>
    </>
  );
}

function Card({ bench }: { bench: Bench }): JSX.Element {
  const run = useData<Run>(bench.running ? `/runs/${bench.running}` : null, AGAIN_MS).data;
  return (
    <li class={`card bench ${bench.state}`}>
      <h2><a href={to.bench(bench.name)}>{bench.name}</a></h2>
      <p class="quiet">{[bench.title, bench.simulated ? "simulated" : "", bench.machine ? `at ${bench.machine}` : "", bench.lease ? `reserved by ${bench.lease}` : ""].filter(Boolean).join(", ")}</p>
      <p class="state">{bench.stop_confirmed === false ? "Emergency stop asked for, NOT CONFIRMED" : STATES[bench.state]}</p>
      {bench.why ? <p>{bench.why}</p> : null}
      {run ? <p><a href={to.run(run.id)}>{`Run ${run.id}`}</a>{`: ${run.title || run.plan}, by ${run.requested_by}`}</p> : null}
      {run ? <progress max={1} value={run.share ?? 0} aria-label={`Progress of run ${run.id}`} /> : null}
      <p class="quiet">{bench.waiting === 0 ? "No run waits." : bench.waiting === 1 ? "1 run waits." : `${bench.waiting} runs wait.`} <a href={to.panel(bench.name)} aria-label={`Operator panel of ${bench.name}`}>Operator panel</a></p>
    </li>
  );
}
