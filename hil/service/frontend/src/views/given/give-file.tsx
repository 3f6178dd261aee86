// A plan, a controller, a model or a bench file is given to the service: a file, or text, under a name.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask } from "../../api/client.ts";
import { attempt } from "../../data.ts";
import { Conflict, saved, theirsOf, type Theirs } from "../../editor/conflict.tsx";
import { DraftNotice } from "../../editor/draft-notice.tsx";
import { useDraft } from "../../editor/use-draft.ts";
import type { VersionedKind } from "../../editor/versions.tsx";
import { t } from "../../i18n/text.ts";
import { LimitedField, LONGEST_FILE_NAME } from "../../ui/too-long.tsx";
import { emptyFile } from "../recordings/send-recording.ts";

interface Options {
  kind: VersionedKind;
  submit: string; // what the button is called
  path: string;
  ending: string;
  onGiven: (name: string) => void;
}

export function GiveFile({ kind, submit, path, ending, onGiven }: Options): JSX.Element {
  const draft = useDraft(`give/${kind}`, { name: "", text: "" }, (one) => one.text === ""), { name, text } = draft.value;
  const [theirs, setTheirs] = useState<Theirs | null>(null);
  const take = async (field: HTMLInputElement) => {
    const file = field.files?.[0];
    if (!file) return;
    const text = await file.text();
    if (!text.trim()) {
      field.value = ""; // as if it had never been chosen
      void attempt(() => { throw emptyFile(file.name); });
      return;
    }
    await attempt(() => {}); // what was refused before is over
    draft.set({ text, name: name || file.name.replace(/\.[^.]+$/, "").replace(/[^A-Za-z0-9_.-]/g, "-") });
  };
  const give = (insteadOf: string) => attempt(async () => {
    const file = `${path}/${encodeURIComponent(name)}`;
    // A plan may be replaced by who has seen it; of the others a name stays what it is.
    const there = kind === "plan" ? await saved(() => ask("PUT", `${file}?instead_of=${insteadOf}`, text), () => theirsOf(kind, name, `${file}/text`)) : await ask<null>("PUT", file, text).then(() => null);
    setTheirs(there);
    if (there) return;
    draft.saved();
    onGiven(name);
  });
  const seen = (there: Theirs) => { draft.saved(); onGiven(there.name); };
  return (
    <form onSubmit={(event) => { event.preventDefault(); void give(""); }}>
      <DraftNotice of={draft} />
      {theirs ? <Conflict theirs={theirs} mine={text} keep={{ name: t("Keep mine as the newer version"), do: () => void give(theirs.tag) }} take={() => seen(theirs)} /> : null}
      <div class="row">
        <label class="field">{t("File ({ending})", { ending })}<input type="file" accept={`${ending},text/plain`} onChange={(event) => void take(event.currentTarget)} /></label>
        <LimitedField label={t("Name")} most={LONGEST_FILE_NAME} required pattern="[A-Za-z0-9][A-Za-z0-9_.\-]*" title={t("letters, digits, _ . and -")} value={name} onText={(typed) => draft.set({ text, name: typed })} />
        <button type="submit" class="main" disabled={!name || !text}>{submit}</button>
      </div>
      <label class="field">{t("Text")}<textarea rows={6} spellcheck={false} value={text} onInput={(event) => draft.set({ name, text: event.currentTarget.value })} /></label>
    </form>
  );
}
