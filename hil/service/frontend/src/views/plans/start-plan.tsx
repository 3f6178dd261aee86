// The form that starts a plan: what it will do is predicted first.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Bench, FoundRuns, Plan, Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { t, tx } from "../../i18n/text.ts";
import { go, useQuery } from "../../router.ts";
import { useMe } from "../../session.ts";
import { linkTo } from "../../ui/parts.tsx";
import { listed, torquesOf } from "./plan-facts.ts";
import { ForecastShown, useForecast } from "./forecast.tsx";
import { startFrom, withStart, type Start } from "./start-values.ts";
import { areUsual, changedIn, valuesOf, wrongIn, type Texts } from "./typed-values.ts";
import { VariableFields } from "./variable-fields.tsx";

// That of the last run that this person asked for; '' if there is none.
function useLastPlan(wanted: boolean): string {
  const { name } = useMe(), query = new URLSearchParams({ requested_by: name, most: "1" });
  return useData<FoundRuns>(wanted ? `/run-list?${query}` : null).data?.runs[0]?.run.plan ?? "";
}

// What is chosen and typed, as the address has it. Texts as they are typed stay here: one may not be a number yet.
function useStart(): [Start, (chosen: Start, typed: Texts) => void] {
  const [query, setQuery] = useQuery(), start = startFrom(query), at = JSON.stringify(start);
  const [typed, setTyped] = useState({ at, texts: start.values });
  const put = (chosen: Start, texts: Texts) => {
    const next = withStart(new URLSearchParams(location.search), chosen);
    setTyped({ at: JSON.stringify(startFrom(next)), texts });
    setQuery(next);
  };
  return [typed.at === at ? { ...start, values: typed.texts } : start, put];
}

// Either the bench is given, or the plan; the other is chosen.
export function StartPlan({ bench, plan }: { bench?: string; plan?: string }): JSX.Element {
  const plans = useData<Plan[]>("/plans").data, lastPlan = useLastPlan(plan === undefined);
  const benches = useData<Bench[]>(bench ? null : "/benches").data;
  const [start, put] = useStart(), texts = start.values;
  const chosenPlan = plan ?? (start.plan || lastPlan), found = plans?.find((one) => one.name === chosenPlan);
  const where = bench ?? (start.bench ? benches?.find((one) => one.name === start.bench) : benches?.[0])?.name ?? "";
  const wanted = found && where ? { plan: found.name, bench: where, values: valuesOf(found, texts) } : null;
  const type = (typed: Texts) => { if (found) put({ ...start, plan: plan ? "" : found.name, values: changedIn(found, typed) }, typed); };
  const forecast = useForecast(wanted, wrongIn(found, texts));
  const torques = torquesOf(forecast.forecast ?? (found && areUsual(found, texts) ? found : null)); // with the values as they are typed
  const queue = async (event: Event) => {
    event.preventDefault();
    if (!wanted) return;
    const run = await attempt(() => post<Run>("/runs", { ...wanted, key: crypto.randomUUID?.() ?? "" }));
    if (run) go(to.run(run.id));
  };
  return (
    <form class="start" onSubmit={(event) => void queue(event)}>
      {plan ? null : (
        <label class="field">{t("Plan")}
          <select required value={found?.name ?? ""} onChange={(event) => put({ ...start, plan: event.currentTarget.value, values: {} }, {})}>
            <option value="" disabled>{t("choose a plan …")}</option>
            {plans?.map((one) => <option key={one.name} value={one.name}>{listed(one)}</option>)}
          </select>
        </label>
      )}
      {bench ? null : (
        <label class="field">{t("Bench")}
          <select value={where} onChange={(event) => put({ ...start, bench: event.currentTarget.value, values: found ? changedIn(found, texts) : texts }, texts)}>
            {where ? null : <option value="" disabled>{t("choose …")}</option>}
            {benches?.map((one) => <option key={one.name} value={one.name}>{one.name}</option>)}
          </select>
        </label>
      )}
      {plans && !found && start.plan ? <p class="bad" role="alert">{tx("There is no plan '{name}': <a>all plans</a>", { name: start.plan, a: linkTo(to.list("plans")) })}</p> : null}
      {benches && !where && start.bench ? <p class="bad" role="alert">{tx("There is no bench '{bench}': <a>all benches</a>", { bench: start.bench, a: linkTo(to.list("benches")) })}</p> : null}
      {plan || !found ? null : <p class="quiet"><a href={to.plan(found.name)}>{found.name}</a>{found.description ? `: ${found.description}` : ""}</p>}
      {found ? <VariableFields plan={found} texts={texts} onChange={type} /> : null}
      <button type="submit" class="main" disabled={!wanted || forecast.refused}>{t("Queue the run")}</button>
      <div class="forecast" aria-live="polite">
        {torques ? <p>{t("Largest torque asked for: {torques}.", { torques })}</p> : null}
        {found ? <ForecastShown of={forecast} /> : null}
      </div>
    </form>
  );
}
