// A plan is written: mistakes stand at their lines as it is typed, and beside it what it would do on a bench.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ask, getTagged, getText } from "../../api/client.ts";
import type { PlanCheck } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, isMissing } from "../../data.ts";
import { Conflict, saved, theirsOf, type Theirs } from "../../editor/conflict.tsx";
import { agreedToDiscard, DraftNotice } from "../../editor/draft-notice.tsx";
import { TextEditor } from "../../editor/text-editor.tsx";
import { useCheck } from "../../editor/use-check.ts";
import { useDraft } from "../../editor/use-draft.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { Section } from "../../ui/parts.tsx";
import { nameIn, writtenName } from "./plan-text.ts";
import { WrittenForecast } from "./written-forecast.tsx";

interface Start {
  text: string;
  tag: string; // of the text that it replaces, if it keeps its name; '' if there is none
}

interface Options extends Start {
  item: string; // under which it is kept while it is not saved
  builtIn: boolean;
  basedOn?: string;
  onTaken?: (theirs: Start) => void; // what is written on from then
  onSaved?: () => void;
}

export function PlanEditor({ text: given, tag: givenTag, item, builtIn, basedOn = "", onTaken, onSaved }: Options): JSX.Element {
  const draft = useDraft<Start>(item, { text: given, tag: givenTag }, (one) => one.text === given), { text, tag } = draft.value;
  const [theirs, setTheirs] = useState<Theirs | null>(null), name = nameIn(text);
  const setText = (typed: string) => draft.set({ text: typed, tag });
  const checked = useCheck<PlanCheck>("/plan-checks", { name: name ?? UNNAMED, text });
  const check = checked.text === text ? checked.check : null, sound = check !== null && !check.mistakes.length;
  const keep = (insteadOf: string) => attempt(async () => {
    if (name === null) return;
    const path = `/plans/${encodeURIComponent(name)}`, query = new URLSearchParams({ ...(basedOn ? { based_on: basedOn } : {}), instead_of: insteadOf });
    const there = await saved(() => ask("PUT", `${path}?${query}`, text), () => theirsOf("plan", name, `${path}/text`));
    setTheirs(there);
    if (there) return;
    draft.saved();
    onSaved?.();
    go(to.plan(name));
  });
  const take = async () => {
    if (theirs === null || !(await agreedToDiscard())) return;
    draft.saved();
    if (theirs.name === basedOn && onTaken) onTaken(theirs);
    else go(to.plan(theirs.name));
  };
  const action = { name: name ? t("Keep as {name}", { name }) : t("Keep the plan"), missing: name === null ? whyNoName(writtenName(text)) : "", do: () => void keep(name === basedOn ? tag : "") };
  return (
    <>
      <DraftNotice of={draft} changed={tag !== givenTag} />
      {theirs ? <Conflict theirs={theirs} mine={text} keep={{ name: theirs.by === "" ? t("Give {name} anew", { name: theirs.name }) : t("Keep mine as the newer version"), do: () => void keep(theirs.tag) }} take={() => void take()} /> : null}
      <div class="columns even">
        <TextEditor label={t("Text of the plan")} kind="yaml" schema="plan" text={text} onText={setText} checked={checked} keep={action}>
          {builtIn ? <p class="quiet">{t("A built-in plan stays as it is: this becomes a plan of its own.")}</p> : null}
        </TextEditor>
        <div><Section title={t("What it would do")} label="forecast"><WrittenForecast plan={sound && name !== null ? (check.plan ?? null) : null} text={text} /></Section></div>
      </div>
    </>
  );
}

const UNNAMED = "unnamed"; // so that the rest is checked

const whyNoName = (written: string): string => (written ? t("A plan's name has 1 to 64 letters from A to Z, digits, _, . and -, and begins with a letter or digit: \"{name}\" ({count} characters) is none.", { name: shortened(written), count: [...written].length }) : t("The plan says no name yet."));
const shortened = (name: string): string => ([...name].length > 24 ? `${[...name].slice(0, 20).join("")}…` : name);

interface EditOptions {
  name: string;
  path: string; // of the text; that of a version, if one is written on from
  item: string;
  builtIn: boolean;
  copied: (text: string) => string;
  onSaved: () => void;
}

// The editor of a text that there is; of a plan that is built in, of a copy. What is saved replaces today's text.
export function EditPlan({ name, path, item, builtIn, copied, onSaved }: EditOptions): JSX.Element {
  const [start, setStart] = useState<(Start & { turn: number }) | null>(null), today = `/plans/${encodeURIComponent(name)}/text`;
  useEffect(() => {
    const control = new AbortController();
    void attempt(async () => {
      const now = await getTagged(today, control.signal).catch((error: Error) => { // one that was removed: a version is written on from
        if (path !== today && isMissing({ error })) return { text: "", tag: "" };
        throw error;
      });
      const text = path === today ? now.text : await getText(path, control.signal);
      setStart({ text: copied(text), tag: now.tag, turn: 0 });
    });
    return () => control.abort();
  }, [path]);
  if (start === null) return <p class="quiet">{t("Loading the text …")}</p>;
  const onTaken = ({ text, tag }: Start) => setStart({ text, tag, turn: start.turn + 1 });
  return <PlanEditor key={start.turn} text={start.text} tag={start.tag} item={item} builtIn={builtIn} basedOn={name} onTaken={onTaken} onSaved={onSaved} />;
}
