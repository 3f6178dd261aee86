// Tunings: begun on a model, or as a sequence on a simulated bench within an envelope that a person consents to.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Bench, Model, Plan, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { useMay } from "../../session.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Badge, Heading, Moment, Scroll, Section } from "../../ui/parts.tsx";
import { Consent } from "./consent.tsx";

const AGAIN_MS = 2000;

export function Tunings(): JSX.Element {
  const may = useMay();
  return (
    <>
      <Heading>{t("Tune a controller")}</Heading>
      {may("engineer") ? <Begin /> : null}
      <Section title={t("All tunings")} label="all"><List /></Section>
    </>
  );
}

function List(): JSX.Element {
  const all = [...(useData<Study[]>("/studies?kind=tuning", AGAIN_MS).data ?? []), ...(useData<Study[]>("/studies?kind=autotuning", AGAIN_MS).data ?? [])].sort((one, other) => other.id - one.id);
  if (!all.length) return <p class="quiet">{t("None yet.")}</p>;
  return (
    <Scroll label={t("Tunings")}><table>
      <thead><tr><th scope="col" class="number">{t("number")}</th><th scope="col">{t("kind")}</th><th scope="col">{t("state")}</th><th scope="col">{t("plan")}</th><th scope="col">{t("model")}</th><th scope="col">{t("bench")}</th><th scope="col">{t("asked for")}</th><th scope="col">{t("by")}</th></tr></thead>
      <tbody>{all.map((one) => <tr key={one.id}><td class="number"><a href={to.tuning(one.id)}>{one.id}</a></td><td>{kindInWords(one.kind)}</td><td><Badge kind={one.state} />{one.reason ? <span class="reason"><English>{one.reason}</English></span> : null}</td><td>{one.plan}</td><td>{one.model}</td><td>{one.bench}</td><td><Moment at={one.asked_at} /></td><td>{one.requested_by}</td></tr>)}</tbody>
    </table></Scroll>
  );
}

const KEPT = { response_time: t("response time"), steady_error: t("steady error"), torque_effort: t("torque effort"), stability: t("stability margins"), criteria: t("criteria") } as const;

function Begin(): JSX.Element {
  const plans = useData<Plan[]>("/plans").data ?? [], models = useData<Model[]>("/models").data ?? [], benches = (useData<Bench[]>("/benches").data ?? []).filter((one) => one.simulated && !one.machine);
  const [plan, setPlan] = useState("acceptance"), [model, setModel] = useState("three_inertia"), [bench, setBench] = useState("");
  const [draws, setDraws] = useState("0"), [minutes, setMinutes] = useState("10"), [letGo, setLetGo] = useState<string[]>([]);
  const on = bench || benches[0]?.name || "", common = { plan, model, bench: on, draws: Number(draws) };
  const begin = async (event: Event) => {
    event.preventDefault();
    const study = await attempt(() => post<Study>("/tunings", { ...common, at_most_min: Number(minutes), may_worsen: letGo }));
    if (study) go(to.tuning(study.id));
  };
  const choice = (name: string, value: string, names: string[], onChange: (name: string) => void) => (
    <label class="field">{name}<select value={value} onChange={(event) => onChange(event.currentTarget.value)}>{names.map((one) => <option key={one}>{one}</option>)}</select></label>
  );
  return (
    <>
      <form class="card" onSubmit={(event) => void begin(event)}>
        <h2>{t("Tune on a model")}</h2>
        <div class="fields">
          {choice(t("Plan"), plan, plans.map((one) => one.name), setPlan)}
          {choice(t("Model"), model, models.filter((one) => one.kind !== "transfer_function").map((one) => one.name), setModel)}
          {choice(t("Simulated bench"), on, benches.map((one) => one.name), setBench)}
          <label class="field">{t("Cars drawn around the model")}<NumberInput min={0} max={500} whole required value={draws} onText={setDraws} /></label>
          <label class="field">{t("Time limit in minutes")}<NumberInput min={0.1} max={120} required value={minutes} onText={setMinutes} /></label>
        </div>
        <fieldset class="ticks"><legend>{t("May get worse than with the plan's controller")}</legend>
          {Object.entries(KEPT).map(([name, words]) => <label class="tick" key={name}><input type="checkbox" checked={letGo.includes(name)} onChange={(event) => setLetGo(event.currentTarget.checked ? [...letGo, name] : letGo.filter((one) => one !== name))} />{words}</label>)}
        </fieldset>
        <button type="submit" class="main" disabled={!on}>{t("Tune")}</button>
      </form>
      <Consent key={JSON.stringify(common)} planned={common} disabled={!on} />
    </>
  );
}
