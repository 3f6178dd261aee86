// Runs that wait for a bench, in their order.

import type { JSX } from "preact";
import { ask, post } from "../api/client.ts";
import type { Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tx } from "../i18n/text.ts";
import { useMay, useMe } from "../session.ts";
import { linkTo } from "../ui/parts.tsx";
import { nameOf } from "./runs/run-name.ts";
import { Admit, WhenExpected } from "./team/expected.tsx";

export function Queue({ runs }: { runs: Run[] }): JSX.Element {
  if (!runs.length) return <p class="quiet">{t("The queue is empty.")}</p>;
  return <ol class="queue">{runs.map((run) => <Waiting key={run.id} run={run} />)}</ol>;
}

function Waiting({ run }: { run: Run }): JSX.Element {
  const may = useMay(), me = useMe();
  const sooner = () => void attempt(() => ask("PATCH", `/runs/${run.id}`, { priority: Math.min(100, run.priority + 1) }));
  return (
    <li>
      <span>
        {tx("<a>{run}</a>: {plan}, by {person}", { a: linkTo(to.run(run.id)), run: run.id, plan: nameOf(run), person: run.requested_by })}
        {run.state === "waiting_approval" ? <span class="reason">{t("waits for approval: {hazard}", { hazard: run.hazard })}</span> : null}
        {run.reason ? <span class="reason"><English>{run.reason}</English></span> : null}
        <WhenExpected run={run} />
      </span>
      <span class="buttons">
        <Admit run={run} />
        {run.state === "waiting_approval" && may("engineer") && run.requested_by !== me.name
          ? <button type="button" aria-label={t("Approve run {run}", { run: run.id })} onClick={() => void attempt(() => post(`/runs/${run.id}/approve`))}>{t("Approve")}</button> : null}
        {may("engineer") ? <button type="button" aria-label={t("Run {run} sooner", { run: run.id })} onClick={sooner}>{t("Sooner")}</button> : null}
        {may("operator") ? <button type="button" aria-label={t("Cancel run {run}", { run: run.id })} onClick={() => void attempt(() => post(`/runs/${run.id}/abort`))}>{t("Cancel")}</button> : null}
      </span>
    </li>
  );
}
