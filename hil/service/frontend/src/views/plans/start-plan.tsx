// The form that starts a plan: what it will do is predicted first.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Bench, FoundRuns, Plan, Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { useMe } from "../../session.ts";
import { listed, torquesOf } from "./plan-facts.ts";
import { ForecastShown, useForecast } from "./forecast.tsx";
import { areUsual, valuesOf, wrongIn } from "./typed-values.ts";
import { VariableFields } from "./variable-fields.tsx";

// Of an earlier run: its bench, and values of its variables as texts.
export interface StartedFrom {
  bench: string;
  values: Record<string, string>;
}

// That of the last run that this person asked for; '' if there is none.
function useLastPlan(wanted: boolean): string {
  const { name } = useMe(), query = new URLSearchParams({ requested_by: name, most: "1" });
  return useData<FoundRuns>(wanted ? `/run-list?${query}` : null).data?.runs[0]?.run.plan ?? "";
}

// Either the bench is given, or the plan; the other is chosen.
export function StartPlan({ bench, plan, from }: { bench?: string; plan?: string; from?: StartedFrom }): JSX.Element {
  const plans = useData<Plan[]>("/plans").data ?? [], lastPlan = useLastPlan(plan === undefined);
  const benches = useData<Bench[]>(bench ? null : "/benches").data ?? [];
  const [chosenPlan, setPlan] = useState(plan ?? "");
  const [chosenBench, setBench] = useState(bench ?? from?.bench ?? "");
  const [texts, setTexts] = useState<Record<string, string>>(from?.values ?? {});
  const found = plans.find((one) => one.name === (chosenPlan || lastPlan));
  const where = chosenBench || benches[0]?.name || "";
  const wanted = found && where ? { plan: found.name, bench: where, values: valuesOf(found, texts) } : null;
  const forecast = useForecast(wanted, wrongIn(found, texts));
  const torques = torquesOf(forecast.forecast ?? (found && areUsual(found, texts) ? found : null)); // with the values as they are typed
  const start = async (event: Event) => {
    event.preventDefault();
    if (!wanted) return;
    const run = await attempt(() => post<Run>("/runs", { ...wanted, key: crypto.randomUUID?.() ?? "" }));
    if (run) go(to.run(run.id));
  };
  return (
    <form class="start" onSubmit={(event) => void start(event)}>
      {plan ? null : (
        <label class="field">{t("Plan")}
          <select required value={found?.name ?? ""} onChange={(event) => { setPlan(event.currentTarget.value); setTexts({}); }}>
            <option value="" disabled>{t("choose a plan …")}</option>
            {plans.map((one) => <option key={one.name} value={one.name}>{listed(one)}</option>)}
          </select>
        </label>
      )}
      {bench ? null : (
        <label class="field">{t("Bench")}
          <select value={where} onChange={(event) => setBench(event.currentTarget.value)}>
            {benches.map((one) => <option key={one.name} value={one.name}>{one.name}</option>)}
          </select>
        </label>
      )}
      {plan || !found ? null : <p class="quiet"><a href={to.plan(found.name)}>{found.name}</a>{found.description ? `: ${found.description}` : ""}</p>}
      {found ? <VariableFields plan={found} texts={texts} onChange={setTexts} /> : null}
      <button type="submit" class="main" disabled={!wanted || forecast.refused}>{t("Queue the run")}</button>
      <div class="forecast" aria-live="polite">
        {torques ? <p>{t("Largest torque asked for: {torques}.", { torques })}</p> : null}
        {found ? <ForecastShown of={forecast} /> : null}
      </div>
    </form>
  );
}
