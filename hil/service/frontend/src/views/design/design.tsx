// The design studio: controllers drafted by hand; loop, sensitivity, margins and steps follow what is moved.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Model } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Heading, Section } from "../../ui/parts.tsx";
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
  if (!may("engineer")) return <><Heading>{t("Design a controller")}</Heading><p>{t("Engineers design controllers.")}</p></>;
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
      <Heading>{t("Design a controller")}</Heading>
      <div class="row">
        <label>{t("Model")}{" "}
          <select value={model} onChange={(event) => put("model", event.currentTarget.value)}>
            {models.some((one) => one.name === model) || !model ? null : <option>{model}</option>}
            {models.map((one) => <option key={one.name} value={one.name}>{[one.name, kindInWords(one.kind), one.warning ? t("doubtful") : ""].filter(Boolean).join(", ")}</option>)}
          </select>
        </label>
      </div>
      {model ? <OnModel key={model} model={model} drafts={draftsFrom(query.get("d"))} onDrafts={(drafts) => put("d", draftsText(drafts))} /> : <p class="quiet">{t("Loading models …")}</p>}
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
        <section class="card" aria-label={t("Drafts")}>
          <div class="row level small" role="group" aria-label={t("Draft that is moved")}>
            {named.map(({ name, role }, number) => (
              <button type="button" key={number} aria-pressed={number === at} onClick={() => setShown(number)}><span class={`swatch ${role}`} />{` ${name}`}</button>
            ))}
            {drafts.length < MOST_DRAFTS ? <button type="button" class="plain" onClick={add}>{t("Add another")}</button> : null}
            {drafts.length > 1 ? <button type="button" class="plain" onClick={() => { onDrafts(drafts.filter((_, number) => number !== at)); setShown(0); }}>{t("Leave out {name}", { name: nameOf(at, draft) })}</button> : null}
          </div>
          <DraftForm draft={draft} resonance={found?.resonance_hz ?? null} onChange={change} />
        </section>
        <DraftPlots drafts={named} />
      </div>
      <Section title={t("Margins and peaks")} label="figures"><DraftFigures drafts={named} /></Section>
      <Section title={t("Keep {name}", { name: nameOf(at, draft) })} label="keep"><SaveController body={bodyOf(model, draft)} onSaved={setSaved} /></Section>
      <Section title={t("Use a controller in a plan")} label="use"><UseController key={saved} controller={saved} /></Section>
    </>
  );
}
