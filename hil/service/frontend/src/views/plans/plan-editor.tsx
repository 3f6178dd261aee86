// A plan is written: mistakes stand at their lines as it is typed, and beside it what it would do on a bench.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { ask, getText, post } from "../../api/client.ts";
import type { PlanCheck, PlanMistake } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { Section } from "../../ui/parts.tsx";
import { lineAt, nameIn } from "./plan-text.ts";
import { WrittenForecast } from "./written-forecast.tsx";

const WAIT_MS = 300;

interface Checked {
  text: string; // of which this is known
  check: PlanCheck | null;
  error: string;
}

export function PlanEditor({ text: given, builtIn }: { text: string; builtIn: boolean }): JSX.Element {
  const [text, setText] = useState(given), name = nameIn(text);
  const { check, text: known, error } = useCheck(name, text);
  const field = useRef<HTMLTextAreaElement>(null);
  const mistakes = known === text ? (check?.mistakes ?? []) : [], sound = known === text && check !== null && !mistakes.length;
  const keep = async (event: Event) => {
    event.preventDefault();
    const kept = name && await attempt(async () => { await ask("PUT", `/plans/${encodeURIComponent(name)}`, text); return true; });
    if (kept) go(to.plan(name));
  };
  const show = ({ line }: PlanMistake) => {
    if (line === null || !field.current) return;
    field.current.focus();
    field.current.setSelectionRange(...lineAt(text, line));
  };
  return (
    <form class="columns" onSubmit={(event) => void keep(event)}>
      <div>
        <Lines text={text} wrong={mistakes.map((one) => one.line)} field={field} onText={setText} />
        <div class="row level"><button type="submit" class="main" disabled={!sound}>{name ? t("Keep as {name}", { name }) : t("Keep the plan")}</button>
          <span class="quiet" role="status">{name === null ? t("The plan says no name yet.") : error ? <English>{error}</English> : (known !== text ? t("Checking …") : sound ? t("No mistake was found.") : tn("{count} mistake", "{count} mistakes", mistakes.length))}</span>
        </div>
        <ul class="mistakes" aria-label={t("Mistakes")}>{mistakes.map((one) => <li key={`${one.line} ${one.key} ${one.text}`}>{one.line === null ? null : <button type="button" class="plain" onClick={() => show(one)}>{t("line {line}", { line: one.line })}</button>} <English>{`${one.key ? `${one.key}: ` : ""}${one.text}`}</English></li>)}</ul>
        {builtIn ? <p class="quiet">{t("A built-in plan stays as it is: this becomes a plan of its own.")}</p> : null}
      </div>
      <div><Section title={t("What it would do")} label="forecast"><WrittenForecast plan={sound ? (check?.plan ?? null) : null} text={text} /></Section></div>
    </form>
  );
}

function useCheck(name: string | null, text: string): Checked {
  const [checked, setChecked] = useState<Checked>({ text: "", check: null, error: "" });
  useEffect(() => {
    if (name === null) return undefined;
    let current = true;
    const look = async () => {
      try {
        const check = await post<PlanCheck>("/plan-checks", { name, text });
        if (current) setChecked({ text, check, error: "" });
      } catch (error) {
        if (current) setChecked({ text, check: null, error: (error as Error).message });
      }
    };
    const timer = setTimeout(() => void look(), WAIT_MS);
    return () => { current = false; clearTimeout(timer); };
  }, [name, text]);
  return checked;
}

interface LinesOptions {
  text: string;
  wrong: (number | null)[];
  field: { current: HTMLTextAreaElement | null };
  onText: (text: string) => void;
}

// Numbers beside the text move with it.
function Lines({ text, wrong, field, onText }: LinesOptions): JSX.Element {
  const numbers = useRef<HTMLDivElement>(null);
  const count = text.split("\n").length;
  return (
    <div class="editor">
      <div class="numbers" ref={numbers} aria-hidden="true">{Array.from({ length: count }, (_, at) => <div key={at} class={wrong.includes(at + 1) ? "wrong" : ""}>{at + 1}</div>)}</div>
      <textarea ref={field} aria-label={t("Text of the plan")} rows={28} wrap="off" spellcheck={false} autocomplete="off" maxLength={200_000} aria-invalid={wrong.length > 0} value={text}
        onInput={(event) => onText(event.currentTarget.value)} onScroll={(event) => { if (numbers.current) numbers.current.scrollTop = event.currentTarget.scrollTop; }} />
    </div>
  );
}

// The editor of a plan that there is; of one that is built in, of a copy.
export function EditPlan({ name, builtIn, copied }: { name: string; builtIn: boolean; copied: (text: string) => string }): JSX.Element {
  const [text, setText] = useState<string | null>(null);
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => setText(copied(await getText(`/plans/${encodeURIComponent(name)}/text`, control.signal))));
    return () => control.abort();
  }, [name]);
  return text === null ? <p class="quiet">{t("Loading the text …")}</p> : <PlanEditor text={text} builtIn={builtIn} />;
}
