// When a queued run is expected to start, and whose reservation it waits for.

import type { JSX } from "preact";
import { ask } from "../../api/client.ts";
import type { Run } from "../../api/types.ts";
import { attempt } from "../../data.ts";
import { moment } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { useMay, useMe } from "../../session.ts";

export function WhenExpected({ run }: { run: Run }): JSX.Element | null {
  const held = run.waits_for;
  const when = run.expected_start
    ? run.expected_end
      ? t("Expected from {start} to {end}", { start: moment(run.expected_start), end: moment(run.expected_end) })
      : t("Expected from {start}", { start: moment(run.expected_start) })
    : "";
  if (!held && !when) return null;
  return (
    <>
      {held ? <span class="reason">{t("Waits for the reservation of {who} until {end}: {reason}", { who: held.who, end: moment(held.ends), reason: held.reason })}</span> : null}
      {when ? <span class="reason">{when}</span> : null}
    </>
  );
}

// Whoever has reserved the bench may let a run of somebody else start all the same.
export function Admit({ run }: { run: Run }): JSX.Element | null {
  const may = useMay(), me = useMe(), held = run.waits_for;
  if (!held || !may("operator") || (held.who !== me.name && !may("admin"))) return null;
  const path = `/benches/${encodeURIComponent(run.bench)}/reservations/${held.id}/runs/${run.id}`;
  return <button type="button" aria-label={t("Let it start: run {run}", { run: run.id })} onClick={() => void attempt(() => ask("PUT", path))}>{t("Let it start")}</button>;
}
