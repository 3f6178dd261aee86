// What a plan that is being written would do on a bench, with the usual values of its variables.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Bench, Plan } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { ForecastShown, useForecast } from "./forecast.tsx";
import { t } from "../../i18n/text.ts";

export function WrittenForecast({ plan, text }: { plan: Plan | null; text: string }): JSX.Element {
  const benches = (useData<Bench[]>("/benches").data ?? []).map((one) => one.name), [chosen, setBench] = useState("");
  const bench = chosen || benches[0] || "";
  const values = Object.fromEntries(Object.entries(plan?.variables ?? {}).map(([name, one]) => [name, one.default]));
  const forecast = useForecast(plan && bench ? { plan: plan.name, bench, values, text } : null);
  return (
    <>
      <label class="field">{t("Bench")}<select value={bench} onChange={(event) => setBench(event.currentTarget.value)}>{benches.map((one) => <option key={one}>{one}</option>)}</select></label>
      <div class="forecast" aria-live="polite">{plan ? <ForecastShown of={forecast} criteria /> : <p class="quiet">{t("It is predicted when no mistake is left.")}</p>}</div>
    </>
  );
}
