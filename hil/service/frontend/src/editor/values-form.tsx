// Values of a file as a form made of its schema, beside its text: both change the same.

import type { JSX } from "preact";
import { useData } from "../data.ts";
import { unitIn, wordsOf } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { NumberInput } from "../ui/number-field.tsx";
import { Section } from "../ui/parts.tsx";
import { changed, isNumber, scalarsOf, type Scalar } from "./scalars.ts";
import type { Schema } from "./schema.ts";

const MOST = 120;

export function ValuesForm({ schema, text, onText }: { schema: string; text: string; onText: (text: string) => void }): JSX.Element | null {
  const rules = useData<Schema>(`/schemas/${schema}`).data;
  const scalars = rules ? scalarsOf(rules, text).slice(0, MOST) : [];
  if (!scalars.length) return null;
  return (
    <Section title={t("Values")} label="values">
      <div class="values">{scalars.map((one, at) => <Field key={`${at} ${one.table} ${one.key.name}`} of={one} onValue={(value) => onText(changed(text, one, value))} />)}</div>
    </Section>
  );
}

function Field({ of, onValue }: { of: Scalar; onValue: (value: string) => void }): JSX.Element {
  const { key, value, table } = of, about = [unitIn(key.name), key.about].filter(Boolean).join(", "), bare = value.replace(/^"(.*)"$/, "$1");
  const name = <>{table ? <span class="quiet">{`${table} `}</span> : null}{wordsOf(key.name)}{about ? <span class="quiet">{" "}<English>{about}</English></span> : null}</>;
  const choices = key.values.includes(bare) ? key.values : null;
  return (
    <label class="field"><span>{name}</span>
      {choices ? <select value={bare} onChange={(event) => onValue(event.currentTarget.value)}>{choices.map((one) => <option key={one}>{one}</option>)}</select>
        : isNumber(of) ? <NumberInput rested required min={key.lower ?? undefined} max={key.upper ?? undefined} value={bare} onText={(number) => { if (number) onValue(number); }} />
        : <input value={bare} onChange={(event) => onValue(event.currentTarget.value)} />}
    </label>
  );
}
