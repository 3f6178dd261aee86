// A trend is of runs of one and the same test: of one text of a plan, with the same values of its variables.

import type { JSX } from "preact";
import type { FoundRuns, Plan } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { useData } from "../../data.ts";
import { t, tn, tx } from "../../i18n/text.ts";
import { linkTo } from "../../ui/parts.tsx";
import { groupsOf, type SameValues } from "./by-values.ts";

const LOOKED_AT = "100";

// Runs that were judged, by their values; null while they are asked for.
export function useSameValues(bench: string, plan: string): SameValues[] | null {
  const query = new URLSearchParams([["bench", bench], ["plan", plan], ["state", "ended"], ...["pass", "fail", "done"].map((verdict) => ["verdict", verdict]), ["most", LOOKED_AT]] as string[][]);
  const runs = useData<FoundRuns>(`/run-list?${query}`).data, all = useData<Plan[]>("/plans").data;
  if (!runs || !all) return null;
  const variables = Object.entries(all.find((one) => one.name === plan)?.variables ?? {});
  return groupsOf(runs.runs.map(({ run }) => run), Object.fromEntries(variables.map(([name, one]) => [name, one.default])));
}

// Of which runs the trend is, and, where there are others, the choice of theirs.
export function WhichRuns({ of, like, onChoose }: { of: SameValues[]; like: number | null; onChoose: (run: number) => void }): JSX.Element | null {
  const shown = of.find((one) => one.run === like) ?? (like === null ? of[0] : undefined), run = like ?? shown?.run;
  if (run === undefined) return null;
  const as = { a: linkTo(to.run(run)), run };
  return (
    <>
      <p class="quiet">{shown?.values ? tx("Only runs with the values and the plan's text of <a>run {run}</a>: {values}.", { ...as, values: shown.values }) : tx("Only runs with the values and the plan's text of <a>run {run}</a>.", as)}</p>
      {of.length > 1 ? (
        <div class="row small">
          <label>{t("Values")}{" "}<select value={String(shown?.run ?? "")} onChange={(event) => onChoose(Number(event.currentTarget.value))}>
            {shown ? null : <option value="">{t("run {run}", { run })}</option>}
            {of.map((one) => <option key={one.run} value={one.run}>{`${one.values || "–"} (${tn("{count} run", "{count} runs", one.count)})`}</option>)}
          </select></label>
        </div>
      ) : null}
    </>
  );
}
