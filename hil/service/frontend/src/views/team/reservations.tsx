// Who has a bench for themselves, from when to when and why; a form to have it oneself.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../../api/client.ts";
import type { Reservation } from "../../api/types.ts";
import { attempt, useData } from "../../data.ts";
import { moment } from "../../format.ts";
import { t, tx } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { useMay, useMe } from "../../session.ts";
import { Store } from "../../store.ts";
import { Moment, Section } from "../../ui/parts.tsx";
import { Refusal } from "../../ui/refusal.tsx";
import { isTooLong, LimitedField } from "../../ui/too-long.tsx";
import { fieldOf, momentOf, nextHour, spanAround, spanProblem } from "./local-times.ts";

const AGAIN_MS = 5000;
const HOUR_MS = 3_600_000;
const LONGEST_REASON = 200;

export function Reservations({ bench }: { bench: string }): JSX.Element {
  const path = `/benches/${encodeURIComponent(bench)}/reservations`;
  const found = useData<Reservation[]>(path, AGAIN_MS), may = useMay();
  const all = found.data ?? [];
  const remove = async (one: Reservation) => { if (await agreed(t("Remove the reservation of {who}?", { who: one.who }), t("Remove"), t("Cancel"))) void attempt(() => ask("DELETE", `${path}/${one.id}`)).then(found.again); };
  return (
    <Section title={t("Reservations")} label="reservations">
      {all.length
        ? <ul class="queue">{all.map((one) => <Row key={one.id} one={one} onRemove={() => void remove(one)} />)}</ul>
        : <p class="quiet">{t("Nobody has reserved the bench.")}</p>}
      {may("operator") ? <details><summary>{t("Reserve the bench")}</summary><Form path={path} onDone={found.again} /></details> : null}
    </Section>
  );
}

function Row({ one, onRemove }: { one: Reservation; onRemove: () => void }): JSX.Element {
  const may = useMay(), me = useMe();
  const now = Date.now() >= Date.parse(one.begins);
  return (
    <li class={now ? "now" : ""}>
      <span>
        {t("{who}: {reason}", { who: one.who, reason: one.reason })}
        <span class="reason">{now ? tx("now, until {end}", { end: <Moment at={one.ends} /> }) : tx("{begin} to {end}", { begin: <Moment at={one.begins} />, end: <Moment at={one.ends} /> })}</span>
      </span>
      {may("admin") || (may("operator") && one.who === me.name) ? <button type="button" aria-label={t("Remove the reservation of {who} at {begin}", { who: one.who, begin: moment(one.begins) })} onClick={onRemove}>{t("Remove")}</button> : null}
    </li>
  );
}

function Form({ path, onDone }: { path: string; onDone: () => void }): JSX.Element {
  const [begins, setBegins] = useState(() => fieldOf(nextHour(new Date())));
  const [ends, setEnds] = useState(() => fieldOf(new Date(nextHour(new Date()).getTime() + HOUR_MS)));
  const [reason, setReason] = useState(""), [refused] = useState(() => new Store<Error | null>(null));
  const wanted = { begins: momentOf(begins), ends: momentOf(ends), reason: reason.trim() };
  const problem = spanProblem(begins, ends, new Date()), [first, last] = spanAround(new Date());
  const possible = wanted.begins !== null && wanted.ends !== null && problem === "" && wanted.reason !== "" && !isTooLong(reason, LONGEST_REASON);
  const reserve = async (event: Event) => {
    event.preventDefault();
    if (await attempt(() => post<Reservation>(path, wanted), refused)) {
      setReason("");
      onDone();
    }
  };
  return (
    <form onSubmit={(event) => void reserve(event)} onInput={() => { refused.value = null; }}>
      <label class="field">{t("From")} <input type="datetime-local" required min={fieldOf(first)} max={fieldOf(last)} value={begins} onInput={(event) => setBegins(event.currentTarget.value)} /></label>
      <label class="field">{t("To")} <input type="datetime-local" required min={begins} max={fieldOf(last)} value={ends} onInput={(event) => setEnds(event.currentTarget.value)} /></label>
      <LimitedField label={t("What for")} most={LONGEST_REASON} required value={reason} onText={setReason} />
      <button type="submit" class="main" disabled={!possible}>{t("Reserve")}</button>
      <Refusal of={refused} />
      <p class="bad" role="status">{problem}</p>
      <p class="quiet">{t("Queued runs of others wait meanwhile. A run under way goes on.")}</p>
    </form>
  );
}
