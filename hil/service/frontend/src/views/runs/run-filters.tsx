// What runs are filtered by: choices are what there is, words are looked for in plan, title, device and person.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { RunChoices } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { isTooLong, LimitedField } from "../../ui/too-long.tsx";
import { whyInvalid } from "../../ui/why-invalid.ts";
import { FILTERS, STATES, VERDICTS, type Filter, type RunsQuery } from "./runs-query.ts";

const LONGEST_WORDS = 200;
const NAMES: Record<Filter, string> = { plan: t("Plan"), bench: t("Bench"), dut: t("Device"), verdict: t("Verdict"), requested_by: t("Asked for by"), state: t("State"), tag: t("Tag") };
const WAIT_MS = 300;

export function RunFilters({ query, onChange }: { query: RunsQuery; onChange: (query: RunsQuery) => void }): JSX.Element {
  const found = useData<RunChoices>(`/run-list/choices${query.filters.plan ? `?plan=${encodeURIComponent(query.filters.plan)}` : ""}`).data;
  const [choices, setChoices] = useState<RunChoices | null>(null); // stay while those of another plan are asked for
  useEffect(() => { if (found) setChoices(found); }, [found]);
  const offered: Record<Filter, string[]> = {
    plan: choices?.plans ?? [], bench: choices?.benches ?? [], dut: choices?.duts ?? [], requested_by: choices?.people ?? [], verdict: VERDICTS, state: STATES, tag: choices?.tags ?? [],
  };
  const filtered = FILTERS.some((name) => query.filters[name]) || query.text || query.since || query.until || query.criterion;
  const clear = () => onChange({ ...query, filters: Object.fromEntries(FILTERS.map((name) => [name, ""])) as Record<Filter, string>, text: "", since: "", until: "", criterion: "", above: "", below: "" });
  return (
    <form class="filters small" role="search" aria-label={t("Runs")} onSubmit={(event) => event.preventDefault()}>
      <Typed label={t("Words")} type="search" hint={t("plan, title, device, person, reason, note, tag")} value={query.text} onChange={(text) => onChange({ ...query, text })} />
      {FILTERS.map((name) => (
        <Choice key={name} label={NAMES[name]} value={query.filters[name]} all={offered[name]} onChange={(value) => onChange({ ...query, filters: { ...query.filters, [name]: value } })} />
      ))}
      <Typed label={t("From")} type="date" value={query.since} onChange={(since) => onChange({ ...query, since })} />
      <Typed label={t("To")} type="date" value={query.until} onChange={(until) => onChange({ ...query, until })} />
      <Choice label={t("Criterion")} value={query.criterion} all={choices?.criteria ?? []} onChange={(criterion) => onChange({ ...query, criterion, sort: criterion ? query.sort : query.sort === "value" ? "run" : query.sort })} />
      {query.criterion ? <Typed label={t("at least")} type="number" value={query.above} onChange={(above) => onChange({ ...query, above })} /> : null}
      {query.criterion ? <Typed label={t("at most")} type="number" value={query.below} onChange={(below) => onChange({ ...query, below })} /> : null}
      {filtered ? <button type="button" class="plain" onClick={clear}>{t("Clear all")}</button> : null}
      {query.since && query.until && query.until < query.since ? <p class="bad small" role="alert">{t("“To” is before “From”: no run ended between them.")}</p> : null}
    </form>
  );
}

function Choice({ label, value, all, onChange }: { label: string; value: string; all: string[]; onChange: (value: string) => void }): JSX.Element {
  return (
    <label class="field">{label}
      <select value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        <option value="">{t("all")}</option>
        {value && !all.includes(value) ? <option value={value}>{value}</option> : null}
        {all.map((one) => <option key={one} value={one}>{label === NAMES.verdict || label === NAMES.state ? kindInWords(one) : one}</option>)}
      </select>
    </label>
  );
}

// Asked for when somebody has stopped typing.
function Typed({ label, type, value, onChange, hint = "" }: { label: string; type: "search" | "date" | "number"; value: string; hint?: string; onChange: (value: string) => void }): JSX.Element {
  const [text, setText] = useState(value), latest = useRef(onChange);
  latest.current = onChange; // another filter may have been typed meanwhile
  useEffect(() => setText(value), [value]);
  useEffect(() => {
    if (text === value || isTooLong(text, LONGEST_WORDS)) return undefined;
    const timer = setTimeout(() => latest.current(text), WAIT_MS);
    return () => clearTimeout(timer);
  }, [text]);
  if (type === "search") return <LimitedField label={label} most={LONGEST_WORDS} search placeholder={hint} title={hint} value={text} onText={setText} />;
  return type === "date" ? <Day label={label} value={text} onText={setText} /> : <label class="field">{label}<NumberInput value={text} onText={setText} /></label>;
}

// Half a date is no filter: that is said when the field is left.
function Day({ label, value, onText }: { label: string; value: string; onText: (day: string) => void }): JSX.Element {
  const [why, setWhy] = useState("");
  return (
    <div>
      <label class="field">{label}
        <input type="date" value={value} aria-invalid={why !== ""} onInput={(event) => { setWhy(""); onText(event.currentTarget.value); }} onBlur={({ currentTarget: field }) => setWhy(field.validity.valid ? "" : whyInvalid(field))} />
      </label>
      {why ? <span class="bad small" role="alert">{why}</span> : null}
    </div>
  );
}
