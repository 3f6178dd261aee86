// A controller in place of one that a plan loads: a copy of the plan under a name of its own.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { get, getText, post } from "../../api/client.ts";
import type { Controller, Plan } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { NameField } from "../../ui/name-field.tsx";
import { isTooLong, LONGEST_FILE_NAME } from "../../ui/too-long.tsx";
import { loadedBy } from "./loaded-controllers.ts";

interface Loading {
  plan: Plan;
  files: string[];
}

// Of the page of a plan, that plan; what its run is started with goes on to the copy.
export function UseController({ controller: given = "", plan: first = "", query = "" }: { controller?: string; plan?: string; query?: string }): JSX.Element {
  const [controllers, setControllers] = useState<string[]>([]), [plans, setPlans] = useState<Loading[] | null>(null);
  const [controller, setController] = useState(given), [plan, setPlan] = useState(first), [file, setFile] = useState(""), [name, setName] = useState("");
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => {
      setControllers((await get<Controller[]>("/controllers", control.signal)).map((one) => one.name));
      setPlans(await loadingPlans(control.signal));
    });
    return () => control.abort();
  }, []);
  const of = plans?.find((one) => one.plan.name === plan) ?? (first ? undefined : plans?.[0]);
  const inPlace = of?.files.find((one) => one === file) ?? of?.files[0] ?? "", chosen = controller || controllers[0] || "";
  const joined = of && chosen ? `${of.plan.name}-${chosen}` : "", usual = isTooLong(joined, LONGEST_FILE_NAME) ? "" : joined;
  const make = async (event: Event) => {
    event.preventDefault();
    if (!of) return;
    const made = await attempt(() => post<Plan>(`/plans/${encodeURIComponent(of.plan.name)}/copies`, { name: name || usual, controllers: { [inPlace]: chosen } }));
    if (made) go(to.plan(made.name) + (query ? `?${query}` : ""));
  };
  if (first && plans && !plans.some((one) => one.plan.name === first)) return <p class="quiet">{t("This plan loads no controller by a file.")}</p>;
  return (
    <form class="row" onSubmit={(event) => void make(event)}>
      <label class="field">{t("Controller")}<select value={chosen} onChange={(event) => setController(event.currentTarget.value)}>{controllers.map((one) => <option key={one}>{one}</option>)}</select></label>
      <label class="field">{t("in the plan")}<select value={of?.plan.name ?? ""} onChange={(event) => setPlan(event.currentTarget.value)}>{(plans ?? []).map((one) => <option key={one.plan.name} value={one.plan.name}>{one.plan.title || one.plan.name}</option>)}</select></label>
      <label class="field">{t("in place of")}<select value={inPlace} onChange={(event) => setFile(event.currentTarget.value)}>{(of?.files ?? []).map((one) => <option key={one}>{one}</option>)}</select></label>
      <NameField label={t("as plan")} value={name} onChange={setName} optional={usual !== ""} placeholder={usual} />
      <button type="submit" disabled={!of || !chosen}>{t("Make the plan")}</button>
    </form>
  );
}

async function loadingPlans(signal: AbortSignal): Promise<Loading[]> {
  const plans = await get<Plan[]>("/plans", signal);
  const texts = await Promise.all(plans.map((plan) => getText(`/plans/${encodeURIComponent(plan.name)}/text`, signal)));
  return plans.map((plan, at) => ({ plan, files: loadedBy(texts[at] ?? "") })).filter((one) => one.files.length);
}
