// Trends at an address of their own: of any plan on any bench.

import type { JSX } from "preact";
import type { RunChoices } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { useQuery } from "../../router.ts";
import { Heading } from "../../ui/parts.tsx";
import { Trends } from "./trends.tsx";

export function TrendsView(): JSX.Element {
  const choices = useData<RunChoices>("/run-list/choices").data, [query, setQuery] = useQuery();
  const bench = query.get("bench") ?? choices?.benches[0] ?? "", plan = query.get("plan") ?? choices?.plans[0] ?? "";
  const put = (changed: Record<string, string>) => setQuery(new URLSearchParams({ bench, plan, ...changed }), true);
  const offered = (all: string[], one: string) => (all.includes(one) || !one ? all : [one, ...all]);
  return (
    <>
      <Heading>{t("Trends")}</Heading>
      <div class="row small">
        <label>{t("Bench")}{" "}<select value={bench} onChange={(event) => put({ bench: event.currentTarget.value })}>{offered(choices?.benches ?? [], bench).map((one) => <option key={one}>{one}</option>)}</select></label>
        <label>{t("Plan")}{" "}<select value={plan} onChange={(event) => put({ plan: event.currentTarget.value })}>{offered(choices?.plans ?? [], plan).map((one) => <option key={one}>{one}</option>)}</select></label>
      </div>
      {bench && plan ? <Trends key={`${bench} ${plan}`} bench={bench} plan={plan} empty={t("No run of this plan has ended on this bench with a value of a criterion.")} /> : null}
    </>
  );
}
