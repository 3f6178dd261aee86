// Autotune: what it may ask of the bench at most is predicted and shown, and a person consents to it before it begins.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Envelope, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { duration, figure, wordsOf } from "../../format.ts";
import { t, tn } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { Facts } from "../../ui/parts.tsx";
import { LimitedField } from "../../ui/too-long.tsx";

const LONGEST_NAME = 100;

export function Consent({ planned, disabled }: { planned: object; disabled: boolean }): JSX.Element {
  const [rounds, setRounds] = useState("3"), [runs, setRuns] = useState("6"), [busy, setBusy] = useState(false);
  const [shown, setShown] = useState<{ asked: object; envelope: Envelope } | null>(null), [name, setName] = useState("");
  const asked = { ...planned, rounds: Number(rounds), runs: Number(runs) };
  const ask = async (event: Event) => {
    event.preventDefault();
    setBusy(true);
    const envelope = await attempt(() => post<Envelope>("/autotunings/envelopes", asked));
    setBusy(false);
    setShown(envelope && { asked, envelope });
  };
  const begin = async (event: Event) => {
    event.preventDefault();
    if (!shown) return;
    const { largest, bench_time_s } = shown.envelope;
    const study = await attempt(() => post<Study>("/autotunings", { ...shown.asked, largest, bench_time_s, confirm: name }));
    if (study) go(to.tuning(study.id));
  };
  const number = (label: string, value: string, most: number, onInput: (text: string) => void) => (
    <label class="field">{label}<NumberInput min={1} max={most} whole required value={value} onText={(text) => { onInput(text); setShown(null); }} /></label>
  );
  return (
    <section class="card" aria-label={t("Autotune on a simulated bench")}>
      <h2>{t("Autotune on a simulated bench")}</h2>
      <p class="quiet">{t("Identifies, diagnoses, tunes and confirms by runs, with plan, model, bench and cars as above.")}</p>
      <form class="row" onSubmit={(event) => void ask(event)}>
        {number(t("Rounds"), rounds, 10, setRounds)}{number(t("Runs in a round"), runs, 20, setRuns)}
        <button type="submit" disabled={disabled || busy}>{t("Show what it may ask of the bench")}</button>
      </form>
      <div aria-live="polite">{shown ? <Shown of={shown.envelope} /> : null}</div>
      {shown ? (
        <form class="row" onSubmit={(event) => void begin(event)}>
          <LimitedField label={t("Your name: you consent to these runs")} most={LONGEST_NAME} required autocomplete="name" value={name} onText={setName} />
          <button type="submit" class="main">{t("Consent and begin")}</button>
        </form>
      ) : null}
    </section>
  );
}

function Shown({ of: { bench, largest, units, runs, bench_time_s: seconds } }: { of: Envelope }): JSX.Element {
  return (
    <>
      <p>{tn("At most {count} run on {bench}, {time} of bench time in all. Each is predicted first, refused beyond these limits, and trips if it exceeds them.", "At most {count} runs on {bench}, {time} of bench time in all. Each is predicted first, refused beyond these limits, and trips if it exceeds them.", runs, { bench, time: duration(seconds) })}</p>
      <Facts>{Object.entries(largest).map(([channel, value]): [string, string] => [wordsOf(channel), t("at most {value}", { value: figure(value, units[channel] ?? "") })])}</Facts>
    </>
  );
}
