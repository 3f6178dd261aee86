// Effects that a diagnosis named, and others that the recordings allow with the tests that tell them apart.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../../api/client.ts";
import type { Bench, Diagnosis, Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t, tx } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Badge, inWords, Section } from "../../ui/parts.tsx";
import { planNameOf, significant, percentOf } from "./wording.ts";
import { textOf } from "./study-parts.tsx";

type Effect = Diagnosis["effects"][number];
type Alternative = Diagnosis["alternatives"][number];

export function Effects({ of }: { of: Diagnosis }): JSX.Element {
  const updates = Object.entries(of.parameter_updates);
  return (
    <Section title={<>{t("Effects that the model lacks")} <Badge kind={of.verdict} /></>} label="effects">
      {of.unfinished ? <p>{tx("Unfinished: {why}", { why: <English>{of.unfinished}</English> })}</p> : null}
      {of.effects.length ? <ul>{of.effects.map((one) => <li key={one.id}><Named effect={one} /></li>)}</ul> : <p>{t("None was named.")}</p>}
      {updates.length ? <p>{t("Parameters that change: {names}.", { names: updates.map(([name]) => inWords(name)).join(", ") })}</p> : null}
      {[of.remaining_gap, ...of.notes].filter(Boolean).map((text) => <p key={text} class="quiet"><English>{text}</English></p>)}
    </Section>
  );
}

function Named({ effect: { id, one_of: alike, confidence, parameters, standard_error: errors, channels, band_hz: band, condition } }: { effect: Effect }): JSX.Element {
  const values = Object.entries(parameters).map(([name, value]) => `${name} = ${typeof value === "number" ? significant(value, 4) : value}${errors[name] ? ` ± ${significant(errors[name], 2)}` : ""}`);
  return <><b>{alike ? namesIn(alike) : inWords(id)}</b>{` (${percentOf(confidence)})${values.length ? `: ${values.join(", ")}` : ""}; `}{tx("seen in {channels}, {lower} to {upper} Hz, {condition}", { channels: channels.join(", "), lower: band[0], upper: band[1], condition: <English>{condition}</English> })}</>;
}

/** Names that the data cannot tell apart, in words. */
const namesIn = (alike: string): string => alike.split(" or ").map(inWords).join(` ${t("or")} `);

export function Alternatives({ of }: { of: Diagnosis }): JSX.Element {
  const may = useMay(), files = of.study.files ?? [];
  const benches = (useData<Bench[]>("/benches").data ?? []).map((one) => one.name), [chosen, setBench] = useState("");
  const bench = chosen || benches[0] || "";
  const run = async ({ plan }: Alternative) => {
    const queued = await attempt(async () => {
      const text = await textOf(of.study, plan ?? ""), name = planNameOf(text);
      await ask("PUT", `/plans/${encodeURIComponent(name)}`, text);
      return post<Run>("/runs", { plan: name, bench });
    });
    if (queued) go(to.run(queued.id));
  };
  const runs = (one: Alternative): boolean => may("engineer") && one.plan != null && files.includes(one.plan);
  return (
    <Section title={t("Alternatives")} label="alternatives" aside={of.alternatives.some(runs) && benches.length > 1 ? <label>{t("on bench")} <select value={bench} onChange={(event) => setBench(event.currentTarget.value)}>{benches.map((one) => <option key={one}>{one}</option>)}</select></label> : null}>
      <ul class="spaced">
        {of.alternatives.map((one) => (
          <li key={one.id}>{tx("{effect} ({confidence}); test to distinguish them: {test}", { effect: inWords(one.id), confidence: percentOf(one.confidence), test: <English>{one.separating_test}</English> })}{" "}
            {runs(one) ? <button type="button" disabled={!bench} aria-label={t("Run the separating test on {bench} for {effect}", { bench, effect: inWords(one.id) })} onClick={() => void run(one)}>{t("Run the separating test on {bench}", { bench })}</button> : null}
          </li>
        ))}
      </ul>
    </Section>
  );
}
