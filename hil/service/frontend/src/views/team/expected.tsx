// When a queued run is expected to start, and whose reservation it waits for.

import type { JSX } from "preact";
import { ask } from "../../api/client.ts";
import type { Run } from "../../api/types.ts";
import { attempt } from "../../data.ts";
import { t, tx } from "../../i18n/text.ts";
import { useMay, useMe } from "../../session.ts";
import { Moment } from "../../ui/parts.tsx";

export function WhenExpected({ run }: { run: Run }): JSX.Element | null {
  const held = run.waits_for;
  return (
    <>
      {held ? <span class="reason">{tx("Waits for the reservation of {who} until {end}: {reason}", { who: held.who, end: <Moment at={held.ends} />, reason: held.reason })}</span> : null}
      {run.expected_start ? <span class="reason"><Expected run={run} /></span> : null}
    </>
  );
}

export function Expected({ run: { expected_start: start, expected_end: end } }: { run: Run }): JSX.Element {
  return <>{end ? tx("Expected from {start} to {end}", { start: <Moment at={start} />, end: <Moment at={end} /> }) : tx("Expected from {start}", { start: <Moment at={start} /> })}</>;
}

// Whoever has reserved the bench may let a run of somebody else start all the same.
export function Admit({ run }: { run: Run }): JSX.Element | null {
  const may = useMay(), me = useMe(), held = run.waits_for;
  if (!held || !may("operator") || (held.who !== me.name && !may("admin"))) return null;
  const path = `/benches/${encodeURIComponent(run.bench)}/reservations/${held.id}/runs/${run.id}`;
  return <button type="button" aria-label={t("Let it start: run {run}", { run: run.id })} onClick={() => void attempt(() => ask("PUT", path))}>{t("Let it start")}</button>;
}
