// What people add to a run: words by which it is found again, and what they noticed.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../../api/client.ts";
import type { Note, RunChoices, RunNotes } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { DraftNotice } from "../../editor/draft-notice.tsx";
import { useDraft } from "../../editor/use-draft.ts";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { useMay, useMe } from "../../session.ts";
import { Moment, Section, Written } from "../../ui/parts.tsx";
import { isTooLong, TooLong } from "../../ui/too-long.tsx";

const AGAIN_MS = 5000;
const TAG = "[\\p{L}\\p{N}][\\p{L}\\p{M}\\p{N}_.:\\-]*"; // letters and digits of any script
const LONGEST_TAG = 40, LONGEST_NOTE = 4000;

export function Notes({ run }: { run: number }): JSX.Element {
  const path = `/runs/${run}`, found = useData<RunNotes>(`${path}/notes`, AGAIN_MS), may = useMay();
  const { tags, notes } = found.data ?? { tags: [], notes: [] };
  // Whether it was taken: what was refused stays in its field.
  const change = async (work: () => Promise<unknown>): Promise<boolean> => {
    const taken = await attempt(() => work().then(() => true));
    found.again();
    return taken ?? false;
  };
  if (!may("operator") && !tags.length && !notes.length) return <></>;
  return (
    <Section title={t("Tags and notes")} label="notes">
      <div class="row level small">
        {tags.map((tag) => (
          <span class="chip tag" key={tag}><a href={`${to.list("runs")}?tag=${encodeURIComponent(tag)}`}>{tag}</a>
            {may("operator") ? <button type="button" class="plain" aria-label={t("Take the tag {tag} off", { tag })} onClick={() => void change(() => ask("DELETE", `${path}/tags/${encodeURIComponent(tag)}`))}>×</button> : null}
          </span>
        ))}
        {may("operator") ? <AddTag onAdd={(tag) => change(() => ask("PUT", `${path}/tags/${encodeURIComponent(tag)}`))} /> : null}
      </div>
      {notes.map((note) => <NoteShown key={note.id} note={note} onRemove={() => void change(() => ask("DELETE", `${path}/notes/${note.id}`))} />)}
      {may("operator") ? <AddNote run={run} onAdd={(text) => change(() => post(`${path}/notes`, { text }))} /> : null}
    </Section>
  );
}

function AddTag({ onAdd }: { onAdd: (tag: string) => Promise<boolean> }): JSX.Element {
  const [tag, setTag] = useState(""), choices = useData<RunChoices>("/run-list/choices");
  const add = (event: Event) => {
    event.preventDefault();
    void onAdd(tag).then((taken) => { if (taken) setTag(""); });
  };
  return (
    <form class="row level" onSubmit={add}>
      <label>{t("Tag")}{" "}<input list="known-tags" required pattern={TAG} title={t("letters, digits, _ . : and -")} size={14} autocomplete="off" value={tag} onInput={(event) => setTag(event.currentTarget.value)} /></label>
      <datalist id="known-tags">{(choices.data?.tags ?? []).map((one) => <option key={one} value={one} />)}</datalist>
      <button type="submit" disabled={isTooLong(tag, LONGEST_TAG)}>{t("Add")}</button>
      <TooLong text={tag} most={LONGEST_TAG} />
    </form>
  );
}

function NoteShown({ note, onRemove }: { note: Note; onRemove: () => void }): JSX.Element {
  const may = useMay(), me = useMe();
  const remove = async () => { if (await agreed(t("Remove this note?"), t("Remove"), t("Cancel"))) onRemove(); };
  return (
    <article class="note" aria-label={t("Note of {who}", { who: note.who })}>
      <p class="quiet">{note.who}, <Moment at={note.at} />
        {may("engineer") || (may("operator") && note.who === me.name) ? <button type="button" class="plain" onClick={() => void remove()}>{t("Remove")}</button> : null}
      </p>
      <Written>{note.text}</Written>
    </article>
  );
}

function AddNote({ run, onAdd }: { run: number; onAdd: (text: string) => Promise<boolean> }): JSX.Element {
  const draft = useDraft(`note/${run}`, "", (typed) => !typed.trim()), text = draft.value;
  const add = (event: Event) => {
    event.preventDefault();
    void onAdd(text).then((taken) => { if (taken) draft.discard(); });
  };
  return (
    <form onSubmit={add}>
      <DraftNotice of={draft} />
      <label class="field">{t("Note")}<textarea class="prose" rows={2} value={text} onInput={(event) => draft.set(event.currentTarget.value)} /></label>
      <TooLong text={text} most={LONGEST_NOTE} />
      <button type="submit" disabled={!text.trim() || isTooLong(text, LONGEST_NOTE)}>{t("Add the note")}</button>
    </form>
  );
}
