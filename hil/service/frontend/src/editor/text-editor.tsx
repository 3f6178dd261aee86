// A file is written: mistakes stand at their lines as it is typed, and what may stand at the cursor below.

import type { ComponentChildren, JSX } from "preact";
import { useRef, useState } from "preact/hooks";
import type { PlanMistake } from "../api/types.ts";
import { useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tn } from "../i18n/text.ts";
import { isTooLong, LONGEST_FILE, TooLong } from "../ui/too-long.tsx";
import { lineAt } from "./lines.ts";
import { offersAt, type FileKind, type Offer } from "./offers.ts";
import type { Schema } from "./schema.ts";
import type { Checked } from "./use-check.ts";

interface Options {
  label: string;
  kind: FileKind;
  schema: string; // as the service calls it
  text: string;
  onText: (text: string) => void;
  checked: Checked<{ mistakes: PlanMistake[] }>;
  keep: { name: string; missing: string; do: () => void }; // `missing` says what keeps it from being kept
  children?: ComponentChildren; // under the mistakes
}

export function TextEditor({ label, kind, schema, text, onText, checked, keep, children }: Options): JSX.Element {
  const field = useRef<HTMLTextAreaElement>(null), isKnown = checked.text === text;
  const mistakes = isKnown ? (checked.check?.mistakes ?? []) : [], sound = isKnown && checked.check !== null && !mistakes.length;
  const show = ({ line }: PlanMistake) => {
    if (line === null || !field.current) return;
    field.current.focus();
    field.current.setSelectionRange(...lineAt(text, line));
  };
  const said = !isKnown ? t("Checking …") : checked.error ? <English>{checked.error}</English> : sound ? t("No mistake was found.") : tn("{count} mistake", "{count} mistakes", mistakes.length);
  return (
    <form onSubmit={(event) => { event.preventDefault(); keep.do(); }}>
      <Typed label={label} kind={kind} schema={schema} text={text} wrong={mistakes.map((one) => one.line)} field={field} onText={onText} />
      <TooLong text={text} most={LONGEST_FILE} />
      <div class="row level"><button type="submit" class="main" disabled={!sound || isTooLong(text, LONGEST_FILE) || keep.missing !== ""}>{keep.name}</button>
        <span class="quiet" role="status">{keep.missing || said}</span>
      </div>
      <ul class="mistakes" aria-label={t("Mistakes")}>{mistakes.map((one) => <li key={`${one.line} ${one.key} ${one.text}`}>{one.line === null ? null : <button type="button" class="plain" onClick={() => show(one)}>{t("line {line}", { line: one.line })}</button>}{" "}<English>{`${one.key ? `${one.key}: ` : ""}${one.text}`}</English></li>)}</ul>
      {children}
    </form>
  );
}

interface TypedOptions {
  label: string;
  kind: FileKind;
  schema: string;
  text: string;
  wrong: (number | null)[];
  field: { current: HTMLTextAreaElement | null };
  onText: (text: string) => void;
}

// Numbers beside the text move with it. Ctrl+Space goes to what may stand at the cursor.
function Typed({ label, kind, schema, text, wrong, field, onText }: TypedOptions): JSX.Element {
  const rules = useData<Schema>(`/schemas/${schema}`).data, [at, setAt] = useState<number | null>(null);
  const numbers = useRef<HTMLDivElement>(null), list = useRef<HTMLUListElement>(null);
  const offers = rules && at !== null ? offersAt(rules, kind, text, at) : [];
  const look = () => setAt(field.current?.selectionStart ?? null);
  const insert = (offer: Offer) => {
    const area = field.current;
    if (!area || at === null) return;
    area.focus();
    area.setRangeText(offer.inserted, offer.from, at, "end");
    onText(area.value);
    setAt(area.selectionStart);
  };
  const onKey = (event: KeyboardEvent) => {
    if (event.key !== " " || !event.ctrlKey) return;
    event.preventDefault();
    list.current?.querySelector("button")?.focus();
  };
  return (
    <>
      <div class="editor">
        <div class="numbers" ref={numbers} aria-hidden="true">{text.split("\n").map((_, line) => <div key={line} class={wrong.includes(line + 1) ? "wrong" : ""}>{line + 1}</div>)}</div>
        <textarea ref={field} aria-label={label} rows={28} wrap="off" spellcheck={false} autocomplete="off" aria-invalid={wrong.length > 0 || isTooLong(text, LONGEST_FILE)} value={text}
          onInput={(event) => { onText(event.currentTarget.value); look(); }} onClick={look} onKeyUp={look} onKeyDown={onKey} onScroll={(event) => { if (numbers.current) numbers.current.scrollTop = event.currentTarget.scrollTop; }} />
      </div>
      <div class="offers">
        <p class="quiet">{offers.length ? t("May stand at the cursor; Ctrl+Space goes there:") : t("What may stand at the cursor is listed here.")}</p>
        <ul ref={list} aria-label={t("May stand at the cursor")}>{offers.map((one) => <li key={one.name}><button type="button" class="plain" onClick={() => insert(one)}>{one.name}</button>{one.about ? <span class="quiet"><English>{one.about}</English></span> : null}</li>)}</ul>
      </div>
    </>
  );
}
