// A plan, a controller, a model or a bench file is given to the service: a file, or text, under a name.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask } from "../../api/client.ts";
import { attempt } from "../../data.ts";
import { t } from "../../i18n/text.ts";

interface Options {
  submit: string; // what the button is called
  path: string;
  ending: string;
  onGiven: (name: string) => void;
}

export function GiveFile({ submit, path, ending, onGiven }: Options): JSX.Element {
  const [name, setName] = useState(""), [text, setText] = useState("");
  const take = async (file: File | undefined) => {
    if (!file) return;
    setText(await file.text());
    if (!name) setName(file.name.replace(/\.[^.]+$/, "").replace(/[^A-Za-z0-9_.-]/g, "-"));
  };
  const give = async (event: Event) => {
    event.preventDefault();
    if (await attempt(async () => { await ask("PUT", `${path}/${encodeURIComponent(name)}`, text); return true; })) onGiven(name);
  };
  return (
    <form onSubmit={(event) => void give(event)}>
      <div class="row">
        <label class="field">{t("File ({ending})", { ending })}<input type="file" accept={`${ending},text/plain`} onChange={(event) => void take(event.currentTarget.files?.[0])} /></label>
        <label class="field">{t("Name")}<input required maxLength={64} pattern="[A-Za-z0-9][A-Za-z0-9_.\-]*" autocomplete="off" value={name} onInput={(event) => setName(event.currentTarget.value)} /></label>
        <button type="submit" class="main" disabled={!name || !text}>{submit}</button>
      </div>
      <label class="field">{t("Text")}<textarea rows={6} spellcheck={false} value={text} onInput={(event) => setText(event.currentTarget.value)} /></label>
    </form>
  );
}
