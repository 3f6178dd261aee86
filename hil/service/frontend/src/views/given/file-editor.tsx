// A model, a controller or a bench file is written: its text, its values as a form, and what follows from it.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ask, getText } from "../../api/client.ts";
import type { FileCheck, Model } from "../../api/types.ts";
import { attempt, useData } from "../../data.ts";
import { Conflict, saved, theirsOf, type Theirs } from "../../editor/conflict.tsx";
import { agreedToDiscard, DraftNotice } from "../../editor/draft-notice.tsx";
import { TextEditor } from "../../editor/text-editor.tsx";
import { useCheck } from "../../editor/use-check.ts";
import { useDraft } from "../../editor/use-draft.ts";
import { ValuesForm } from "../../editor/values-form.tsx";
import { figure, wordsOf } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { go, useQuery } from "../../router.ts";
import { NameField } from "../../ui/name-field.tsx";
import { Section } from "../../ui/parts.tsx";
import { isTooLong, LONGEST_FILE_NAME, tooLongText } from "../../ui/too-long.tsx";
import { kindOf, nextName, type GivenKind } from "./kinds.ts";

interface Options {
  kind: GivenKind;
  text: string;
  item: string; // under which it is kept while it is not saved
  basedOn?: string;
}

interface Written {
  text: string;
  chosen: string | null; // as its name
}

export function FileEditor({ kind, text: given, item, basedOn = "" }: Options): JSX.Element {
  const of = kindOf(kind), all = useData<{ name: string }[]>(of.path), taken = (all.data ?? []).map((one) => one.name);
  const draft = useDraft<Written>(item, { text: given, chosen: null }, (one) => one.text === given), { text, chosen } = draft.value;
  const [model, setModel] = useState(""), [theirs, setTheirs] = useState<Theirs | null>(null);
  const setText = (typed: string) => draft.set({ text: typed, chosen }), setName = (name: string) => draft.set({ text, chosen: name });
  const inText = kind === "bench" ? benchName(text) : null, name = inText ?? chosen ?? (basedOn ? nextName(basedOn, taken) : ""), isName = /^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$/.test(name);
  const checked = useCheck<FileCheck>("/file-checks", { kind, name: isName ? name : "unnamed", text, ...(model ? { model } : {}) });
  const check = checked.text === text ? checked.check : null;
  const keep = (text: string, name: string) => attempt(async () => {
    const path = `${of.path}/${encodeURIComponent(name)}`, from = basedOn ? `?based_on=${encodeURIComponent(basedOn)}` : "";
    const there = await saved(() => ask("PUT", `${path}${from}`, text), () => theirsOf(kind, name, `${path}/text`));
    setTheirs(there);
    if (there) { all.again(); return; }
    draft.saved();
    go(of.address(name));
  });
  const next = nextName(theirs?.name ?? "", taken), keepMine = () => void keep(inText === null ? text : named(text, next), next);
  const take = async () => {
    if (theirs === null || !(await agreedToDiscard())) return;
    draft.saved();
    go(of.address(theirs.name));
  };
  const missing = !name ? t("It has no name yet.") : isTooLong(name, LONGEST_FILE_NAME) ? tooLongText(name, LONGEST_FILE_NAME) : !isName ? t("A name has letters, digits, _ and -.") : taken.includes(name) ? t("{name} is there already, and stays what it is: choose another name.", { name }) : "";
  return (
    <>
      <DraftNotice of={draft} />
      {theirs ? <Conflict theirs={theirs} mine={text} keep={{ name: t("Keep mine as {name}", { name: next }), do: keepMine }} take={() => void take()} /> : null}
      <div class="columns">
        <div>
          {inText === null ? <NameField label={t("Name")} value={name} onChange={setName} /> : null}
          <TextEditor label={of.label} kind="toml" schema={kind} text={text} onText={setText} checked={checked} keep={{ name: isName ? t("Keep as {name}", { name }) : t("Keep it"), missing, do: () => void keep(text, name) }} />
        </div>
        <div>
          <Section title={t("What follows from it")} label="figures">
            {kind === "controller" ? <ChooseModel value={model} onChange={setModel} /> : null}
            <div aria-live="polite">{check && !check.mistakes.length ? <Figures of={check} /> : <p class="quiet">{t("It is computed when no mistake is left.")}</p>}</div>
          </Section>
          <ValuesForm schema={kind} text={text} onText={setText} />
        </div>
      </div>
    </>
  );
}

// A bench says its name itself, as a plan does.
const BENCH_NAME = /^name\s*=\s*"([^"]*)"/m;
const benchName = (text: string): string => BENCH_NAME.exec(text)?.[1] ?? "";
const named = (text: string, name: string): string => text.replace(BENCH_NAME, `name = "${name}"`);

function ChooseModel({ value, onChange }: { value: string; onChange: (model: string) => void }): JSX.Element {
  const models = useData<Model[]>("/models").data ?? [];
  useEffect(() => { if (!value && models[0]) onChange(models[0].name); }, [models.length]);
  return <label class="field">{t("Model for its margins")}<select value={value} onChange={(event) => onChange(event.currentTarget.value)}>{models.map((one) => <option key={one.name}>{one.name}</option>)}</select></label>;
}

function Figures({ of }: { of: FileCheck }): JSX.Element {
  return (
    <>
      <table aria-label={t("What follows from it")}><tbody>
        {(of.figures ?? []).map((one, at) => <tr key={at}><th scope="row">{wordsOf(one.name)}</th><td class={one.text ? "" : "number"}>{one.text ? <English>{one.text}</English> : figure(one.value, one.unit)}</td></tr>)}
      </tbody></table>
      {(of.notes ?? []).map((note) => <p class="quiet" key={note}><English>{note}</English></p>)}
    </>
  );
}

// The editor of a text that there is: today's, or that of a version.
export function EditFile({ kind, name, path, item }: { kind: GivenKind; name: string; path: string; item: string }): JSX.Element {
  const [text, setText] = useState<string | null>(null);
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => setText(await getText(path, control.signal)));
    return () => control.abort();
  }, [path]);
  return text === null ? <p class="quiet">{t("Loading the text …")}</p> : <FileEditor kind={kind} text={text} item={item} basedOn={name} />;
}

export function useWritten(): { isNew: boolean; isOn: boolean; version: number | null } {
  const [query] = useQuery(), number = Number(query.get("version"));
  return { isNew: query.get("write") === "new", isOn: query.get("write") === "on", version: Number.isInteger(number) && number > 0 ? number : null };
}
