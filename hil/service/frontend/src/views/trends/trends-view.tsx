// Trends at an address of their own: of any plan on any bench.

import type { JSX } from "preact";
import type { FoundRuns, Run, RunChoices } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { useQuery } from "../../router.ts";
import { Heading } from "../../ui/parts.tsx";
import { Trends } from "./trends.tsx";

export function TrendsView(): JSX.Element {
  const choices = useData<RunChoices>("/run-list/choices").data, [query, setQuery] = useQuery();
  const newest = useNewest(query), isKnown = newest !== undefined;
  const bench = query.get("bench") ?? newest?.bench ?? (isKnown ? choices?.benches[0] : "") ?? "", plan = query.get("plan") ?? newest?.plan ?? (isKnown ? choices?.plans[0] : "") ?? "";
  const put = (changed: Record<string, string>) => setQuery(new URLSearchParams({ bench, plan, ...changed }), true);
  const offered = (all: string[], one: string) => (all.includes(one) || !one ? all : [one, ...all]);
  return (
    <>
      <Heading>{t("Trends")}</Heading>
      {newest === null && choices && !choices.plans.length ? <p class="quiet">{t("No run has ended yet.")}</p> : null}
      <div class="row small">
        <label>{t("Bench")}{" "}<select value={bench} onChange={(event) => put({ bench: event.currentTarget.value })}>{offered(choices?.benches ?? [], bench).map((one) => <option key={one}>{one}</option>)}</select></label>
        <label>{t("Plan")}{" "}<select value={plan} onChange={(event) => put({ plan: event.currentTarget.value })}>{offered(choices?.plans ?? [], plan).map((one) => <option key={one}>{one}</option>)}</select></label>
      </div>
      {bench && plan ? <Trends key={`${bench} ${plan}`} bench={bench} plan={plan} empty={t("No run of this plan has ended on this bench with a value of a criterion.")} /> : null}
    </>
  );
}

// The run that was judged last, of the bench or plan that the address names: that there are values of. Null without
// one, undefined while it is asked for.
function useNewest(query: URLSearchParams): Run | null | undefined {
  const wanted = new URLSearchParams([["state", "ended"], ["verdict", "pass"], ["verdict", "fail"], ["most", "1"]]);
  for (const name of ["bench", "plan"]) if (query.has(name)) wanted.set(name, query.get(name) ?? "");
  const isChosen = query.has("bench") && query.has("plan"), found = useData<FoundRuns>(isChosen ? null : `/run-list?${wanted}`);
  if (isChosen) return null;
  return found.data ? found.data.runs[0]?.run ?? null : found.error ? null : undefined;
}
