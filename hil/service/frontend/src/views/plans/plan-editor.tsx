// A plan is written: mistakes stand at their lines as it is typed, and beside it what it would do on a bench.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ask, getText } from "../../api/client.ts";
import type { PlanCheck } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt } from "../../data.ts";
import { TextEditor } from "../../editor/text-editor.tsx";
import { useCheck } from "../../editor/use-check.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { Section } from "../../ui/parts.tsx";
import { nameIn } from "./plan-text.ts";
import { WrittenForecast } from "./written-forecast.tsx";

export function PlanEditor({ text: given, builtIn, basedOn = "" }: { text: string; builtIn: boolean; basedOn?: string }): JSX.Element {
  const [text, setText] = useState(given), name = nameIn(text);
  const checked = useCheck<PlanCheck>("/plan-checks", name === null ? null : { name, text });
  const check = checked.text === text ? checked.check : null, sound = check !== null && !check.mistakes.length;
  const keep = async () => {
    const from = basedOn ? `?based_on=${encodeURIComponent(basedOn)}` : "";
    const kept = name && await attempt(async () => { await ask("PUT", `/plans/${encodeURIComponent(name)}${from}`, text); return true; });
    if (kept) go(to.plan(name));
  };
  const action = { name: name ? t("Keep as {name}", { name }) : t("Keep the plan"), missing: name === null ? t("The plan says no name yet.") : "", do: () => void keep() };
  return (
    <div class="columns">
      <TextEditor label={t("Text of the plan")} kind="yaml" schema="plan" text={text} onText={setText} checked={checked} keep={action}>
        {builtIn ? <p class="quiet">{t("A built-in plan stays as it is: this becomes a plan of its own.")}</p> : null}
      </TextEditor>
      <div><Section title={t("What it would do")} label="forecast"><WrittenForecast plan={sound ? (check.plan ?? null) : null} text={text} /></Section></div>
    </div>
  );
}

// The editor of a text that there is; of a plan that is built in, of a copy.
export function EditPlan({ name, path, builtIn, copied }: { name: string; path: string; builtIn: boolean; copied: (text: string) => string }): JSX.Element {
  const [text, setText] = useState<string | null>(null);
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => setText(copied(await getText(path, control.signal))));
    return () => control.abort();
  }, [path]);
  return text === null ? <p class="quiet">{t("Loading the text …")}</p> : <PlanEditor text={text} builtIn={builtIn} basedOn={name} />;
}
