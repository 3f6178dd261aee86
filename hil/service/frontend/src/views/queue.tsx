// Runs that wait for a bench, in their order.

import type { JSX } from "preact";
import { ask, post } from "../api/client.ts";
import type { Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt } from "../data.ts";
import { useMay, useMe } from "../session.ts";
import { Admit, WhenExpected } from "./team/expected.tsx";

export function Queue({ runs }: { runs: Run[] }): JSX.Element {
  if (!runs.length) return <p class="quiet">The queue is empty.</p>;
  return <ol class="queue">{runs.map((run) => <Waiting key={run.id} run={run} />)}</ol>;
}

function Waiting({ run }: { run: Run }): JSX.Element {
  const may = useMay(), me = useMe();
  const sooner = () => void attempt(() => ask("PATCH", `/runs/${run.id}`, { priority: Math.min(100, run.priority + 1) }));
  return (
    <li>
      <span>
        <a href={to.run(run.id)}>{run.id}</a>{`: ${run.title || run.plan}, by ${run.requested_by}`}
        {run.state === "waiting_approval" ? <span class="reason">{`waits for approval: ${run.hazard}`}</span> : null}
        {run.reason ? <span class="reason">{run.reason}</span> : null}
        <WhenExpected run={run} />
      </span>
      <span class="buttons">
        <Admit run={run} />
        {run.state === "waiting_approval" && may("engineer") && run.requested_by !== me.name
          ? <button type="button" aria-label={`Approve run ${run.id}`} onClick={() => void attempt(() => post(`/runs/${run.id}/approve`))}>Approve</button> : null}
        {may("engineer") ? <button type="button" aria-label={`Run ${run.id} sooner`} onClick={sooner}>Sooner</button> : null}
        {may("operator") ? <button type="button" aria-label={`Cancel run ${run.id}`} onClick={() => void attempt(() => post(`/runs/${run.id}/abort`))}>Cancel</button> : null}
      </span>
    </li>
  );
}
