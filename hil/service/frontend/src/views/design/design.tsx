// The design studio: controllers drafted by hand; loop, sensitivity, margins and steps follow what is moved.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Model } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Heading, inWords, Section } from "../../ui/parts.tsx";
import { roleOf } from "../../plot/frame.ts";
import { DraftFigures } from "./draft-figures.tsx";
import { DraftForm } from "./draft-form.tsx";
import { DraftPlots } from "./draft-plots.tsx";
import { bodyOf, draftsFrom, draftsText, MOST_DRAFTS, nameOf, usualDraft, type Draft } from "./drafts.ts";
import { SaveController } from "./save-controller.tsx";
import { useDrafts } from "./use-drafts.ts";
import { UseController } from "./use-controller.tsx";

const USUAL_MODEL = "three_inertia";

export function Design(): JSX.Element {
  const may = useMay();
  if (!may("engineer")) return <><Heading>Design a controller</Heading><p>Engineers design controllers.</p></>;
  return <Studio />;
}

function Studio(): JSX.Element {
  const models = useData<Model[]>("/models").data ?? [];
  const [query, setQuery] = useQuery();
  const put = (name: string, value: string) => {
    const next = new URLSearchParams(location.search);
    next.set(name, value);
    setQuery(next);
  };
  const model = query.get("model") ?? models.find((one) => one.name === USUAL_MODEL)?.name ?? models[0]?.name ?? "";
  return (
    <>
      <Heading>Design a controller</Heading>
      <div class="row">
        <label>{"Model "}
          <select value={model} onChange={(event) => put("model", event.currentTarget.value)}>
            {models.some((one) => one.name === model) || !model ? null : <option>{model}</option>}
            {models.map((one) => <option key={one.name} value={one.name}>{`${one.name}, ${inWords(one.kind)}${one.warning ? ", doubtful" : ""}`}</option>)}
          </select>
        </label>
      </div>
      {model ? <OnModel key={model} model={model} drafts={draftsFrom(query.get("d"))} onDrafts={(drafts) => put("d", draftsText(drafts))} /> : <p class="quiet">Loading models …</p>}
    </>
  );
}

function OnModel({ model, drafts, onDrafts }: { model: string; drafts: Draft[]; onDrafts: (drafts: Draft[]) => void }): JSX.Element {
  const [shown, setShown] = useState(0), [saved, setSaved] = useState("");
  const at = Math.min(shown, drafts.length - 1), draft = drafts[at] as Draft;
  const drawn = useDrafts(drafts.map((one) => bodyOf(model, one)));
  const found = drawn[at]?.found ?? null;
  const change = (changed: Draft) => onDrafts(drafts.map((one, number) => (number === at ? changed : one)));
  const add = () => { onDrafts([...drafts, usualDraft(draft.kind === "phase" ? "gain" : "phase")]); setShown(drafts.length); };
  const named = drafts.map((one, number) => ({ name: nameOf(number, one), role: roleOf(number), drawn: drawn[number] ?? { found: null, error: null } }));
  return (
    <>
      <div class="studio">
        <section class="card" aria-label="Drafts">
          <div class="row level small" role="group" aria-label="Draft that is moved">
            {named.map(({ name, role }, number) => (
              <button type="button" key={number} aria-pressed={number === at} onClick={() => setShown(number)}><span class={`swatch ${role}`} />{` ${name}`}</button>
            ))}
            {drafts.length < MOST_DRAFTS ? <button type="button" class="plain" onClick={add}>Add another</button> : null}
            {drafts.length > 1 ? <button type="button" class="plain" onClick={() => { onDrafts(drafts.filter((_, number) => number !== at)); setShown(0); }}>{`Leave out ${nameOf(at, draft)}`}</button> : null}
          </div>
          <DraftForm draft={draft} resonance={found?.resonance_hz ?? null} onChange={change} />
        </section>
        <DraftPlots drafts={named} />
      </div>
      <Section title="Margins and peaks" label="figures"><DraftFigures drafts={named} /></Section>
      <Section title={`Keep ${nameOf(at, draft)}`} label="keep"><SaveController body={bodyOf(model, draft)} onSaved={setSaved} /></Section>
      <Section title="Use a controller in a plan" label="use"><UseController key={saved} controller={saved} /></Section>
    </>
  );
}
