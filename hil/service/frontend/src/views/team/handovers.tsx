// What a shift leaves to the next: the newest note, earlier ones, a form to write one.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Handover } from "../../api/types.ts";
import { attempt, useData } from "../../data.ts";
import { DraftNotice } from "../../editor/draft-notice.tsx";
import { useDraft } from "../../editor/use-draft.ts";
import { dayText } from "../../format.ts";
import { t, tx } from "../../i18n/text.ts";
import { useMay } from "../../session.ts";
import { Moment, Section, Written } from "../../ui/parts.tsx";
import { isTooLong, TooLong } from "../../ui/too-long.tsx";
import { dayOf, shiftAt, spanAround, type Shift } from "./local-times.ts";

const AGAIN_MS = 5000;
const MOST = 50;
const LONGEST = 4000;

const SHIFTS: Record<Shift, () => string> = {
  early: () => t("early shift"), day: () => t("day shift"), late: () => t("late shift"), night: () => t("night shift"),
};

const pathOf = (bench: string): string => `/benches/${encodeURIComponent(bench)}/handovers`;

export function Handovers({ bench }: { bench: string }): JSX.Element {
  const found = useData<Handover[]>(`${pathOf(bench)}?most=${MOST}`, AGAIN_MS), may = useMay();
  const [newest, ...earlier] = found.data ?? [];
  return (
    <Section title={t("Hand-over")} label="handover">
      {newest ? <Note note={newest} /> : <p class="quiet">{t("No shift has left a note.")}</p>}
      {earlier.length ? <details><summary>{t("Earlier notes")}</summary>{earlier.map((note) => <Note key={note.id} note={note} />)}</details> : null}
      {may("operator") ? <details><summary>{t("Write a note for the next shift")}</summary><Form bench={bench} onDone={found.again} /></details> : null}
    </Section>
  );
}

// The newest note alone, for who reads it from a few steps away.
export function NewestHandover({ bench }: { bench: string }): JSX.Element | null {
  const newest = useData<Handover[]>(`${pathOf(bench)}?most=1`, AGAIN_MS).data?.[0];
  return newest ? <section class="big" aria-label={t("Hand-over")}><Note note={newest} /></section> : null;
}

function Note({ note }: { note: Handover }): JSX.Element {
  const shift = SHIFTS[note.shift]();
  return (
    <article class="note" aria-label={t("Hand-over note of {who}", { who: note.who })}>
      <p class="quiet">{tx("{who}, {shift} of {day}, written {at}", { who: note.who, shift, day: dayText(note.day), at: <Moment at={note.at} /> })}</p>
      <Written>{note.text}</Written>
    </article>
  );
}

function Form({ bench, onDone }: { bench: string; onDone: () => void }): JSX.Element {
  const [day, setDay] = useState(() => dayOf(new Date())), [shift, setShift] = useState<Shift>(() => shiftAt(new Date()));
  const draft = useDraft(`handover/${bench}`, "", (typed) => !typed.trim()), text = draft.value;
  const add = async (event: Event) => {
    event.preventDefault();
    if (await attempt(() => post<Handover>(pathOf(bench), { day, shift, text }))) {
      draft.discard();
      onDone();
    }
  };
  return (
    <form onSubmit={(event) => void add(event)}>
      <DraftNotice of={draft} />
      <div class="row">
        <label class="field">{t("Day")} <input type="date" required min={dayOf(spanAround(new Date())[0])} max={dayOf(spanAround(new Date())[1])} value={day} onInput={(event) => setDay(event.currentTarget.value)} /></label>
        <label class="field">{t("Shift")}
          <select value={shift} onChange={(event) => setShift(event.currentTarget.value as Shift)}>
            {(Object.keys(SHIFTS) as Shift[]).map((one) => <option key={one} value={one}>{SHIFTS[one]()}</option>)}
          </select>
        </label>
      </div>
      <label class="field">{t("Note for the next shift")}<textarea class="prose" rows={4} value={text} onInput={(event) => draft.set(event.currentTarget.value)} /></label>
      <TooLong text={text} most={LONGEST} />
      <button type="submit" disabled={!text.trim() || isTooLong(text, LONGEST)}>{t("Leave the note")}</button>
    </form>
  );
}
