// What stands at the head of a run that waits: why, when it is expected to start, and the action that ends it.

import type { JSX } from "preact";
import { post, Refused } from "../../api/client.ts";
import type { Bench, Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { useMay, useMe } from "../../session.ts";
import { Admit, Expected } from "../team/expected.tsx";
import { Reset } from "../reset.tsx";
import { whyItWaits, type Waiting } from "./waiting-words.ts";

const AGAIN_MS = 2000;

export function WhyItWaits({ run }: { run: Run }): JSX.Element {
  const path = `/benches/${encodeURIComponent(run.bench)}`;
  const bench = useData<Bench>(path, AGAIN_MS), known = bench.data;
  const running = useData<Run>(known?.running ? `/runs/${known.running}` : null, AGAIN_MS).data;
  const queue = useData<Run[]>(known ? `${path}/queue` : null, AGAIN_MS).data ?? [];
  const missing = bench.error instanceof Refused && bench.error.status === 404;
  if (!known && !missing) return <p class="quiet">{t("Asking the service …")}</p>;
  const found = whyItWaits(run, { bench: missing ? null : known, running, queue });
  return (
    <section class="banner waiting" aria-label={t("Why it waits")}>
      <p class="lead" role="status" title={found.until}>{found.why}</p>
      {(found.kind === "stop" || found.kind === "in_use" || found.kind === "ending") && known?.why ? <p><English>{known.why}</English></p> : null}
      {found.ends ? <p>{found.ends}</p> : null}
      {run.expected_start ? <p><Expected run={run} /></p> : null}
      <div class="row level"><Ending run={run} kind={found.kind} bench={known} running={running} /></div>
    </section>
  );
}

// The action that ends the waiting, for whoever may do it.
function Ending({ run, kind, bench, running }: { run: Run; kind: Waiting["kind"]; bench: Bench | null; running: Run | null }): JSX.Element | null {
  const may = useMay(), me = useMe();
  if (kind === "approval") return may("engineer") && (run.requested_by !== me.name || !me.tokens) ? <button type="button" class="main" onClick={() => void attempt(() => post(`/runs/${run.id}/approve`))}>{t("Approve")}</button> : null;
  if (kind === "stop" && !running && may("engineer")) return bench ? <Reset bench={bench} next={run} /> : null;
  if (kind === "reservation") return <Admit run={run} />;
  if (running && kind === "run") return <a href={to.run(running.id)}>{t("Run {run}", { run: running.id })}</a>;
  return bench && kind !== "soon" ? <a href={to.bench(bench.name)}>{t("Bench {bench}", { bench: bench.name })}</a> : null;
}
