// The design studio: controllers drafted by hand; loop, sensitivity, margins and steps follow what is moved.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { CloudData, Model } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { useData } from "../../data.ts";
import { t, tx } from "../../i18n/text.ts";
import { useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Heading, linkTo, Section } from "../../ui/parts.tsx";
import { roleOf } from "../../plot/frame.ts";
import { CarFigures, ChooseCars } from "./car-figures.tsx";
import { carsFrom, spreadFrom, spreadText, toleranceOf, USUAL_CARS, type Spread } from "./car-spread.ts";
import { DraftFigures } from "./draft-figures.tsx";
import { DraftForm } from "./draft-form.tsx";
import { DraftPlots } from "./draft-plots.tsx";
import { bodyOf, draftsFrom, draftsText, MOST_DRAFTS, nameOf, usualDraft, type Draft } from "./drafts.ts";
import { SaveController } from "./save-controller.tsx";
import { SegmentMargins } from "./segment-margins.tsx";
import { useDrafts } from "./use-drafts.ts";
import { useRested } from "./use-rested.ts";
import { UseController } from "./use-controller.tsx";

const USUAL_MODEL = "three_inertia";

export function Design(): JSX.Element {
  const may = useMay();
  if (!may("engineer")) return <><Heading>{t("Design a controller")}</Heading><p>{t("Engineers design controllers.")}</p></>;
  return <Studio />;
}

function Studio(): JSX.Element {
  const known = useData<Model[]>("/models").data, models = known ?? [];
  const [query, setQuery] = useQuery();
  const put = (name: string, value: string) => {
    const next = new URLSearchParams(location.search);
    if (value) next.set(name, value); else next.delete(name);
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
      {known && model && !models.some((one) => one.name === model) ? <p class="bad" role="alert">{tx("There is no model '{name}': choose another one here, or give it among <a>all models</a>.", { name: model, a: linkTo(to.list("models")) })}</p> : model ? <OnModel key={model} model={model} drafts={draftsFrom(query.get("d"))} onDrafts={(drafts) => put("d", draftsText(drafts))} query={query} put={put} /> : <p class="quiet">{t("Loading models …")}</p>}
    </>
  );
}

interface Options {
  model: string;
  drafts: Draft[];
  onDrafts: (drafts: Draft[]) => void;
  query: URLSearchParams;
  put: (name: string, value: string) => void;
}

function OnModel({ model, drafts, onDrafts, query, put }: Options): JSX.Element {
  const [shown, setShown] = useState(0), [saved, setSaved] = useState("");
  const at = Math.min(shown, drafts.length - 1), draft = drafts[at] as Draft;
  const drawn = useDrafts(drafts.map((one) => bodyOf(model, one)));
  const found = drawn[at]?.found ?? null;
  const change = (changed: Draft) => onDrafts(drafts.map((one, number) => (number === at ? changed : one)));
  const add = () => { onDrafts([...drafts, usualDraft(draft.kind === "phase" ? "gain" : "phase")]); setShown(drafts.length); };
  const cars = carsFrom(query.get("cars")), spread = spreadFrom(query.get("spread")), plan = query.get("plan") ?? "", asked = bodyOf(model, draft);
  const drawing = asked && { ...asked, cars: cars || 1, tolerance: toleranceOf(spread) };
  const cloud = useRested<CloudData>("/drafts/clouds", cars ? drawing : null);
  const around = useMemo(() => (cloud.data ? { role: roleOf(at), data: cloud.data } : null), [cloud.data, at]);
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
          <ChooseCars cars={cars} spread={spread} onCars={(count) => put("cars", count === USUAL_CARS ? "" : String(count))} onSpread={(one: Spread | null) => put("spread", spreadText(one))} />
        </section>
        <DraftPlots drafts={named} around={around} />
      </div>
      <Section title={t("Margins and peaks")} label="figures"><DraftFigures drafts={named} /></Section>
      <Section title={t("{name} on drawn cars", { name: nameOf(at, draft) })} label="cars"><CarFigures name={nameOf(at, draft)} role={roleOf(at)} cloud={cloud} cars={cars} /></Section>
      <Section title={t("Margins in the segments of a plan")} label="segments"><SegmentMargins name={nameOf(at, draft)} body={drawing} plan={plan} onPlan={(one) => put("plan", one)} /></Section>
      <Section title={t("Keep {name}", { name: nameOf(at, draft) })} label="keep"><SaveController body={bodyOf(model, draft)} onSaved={setSaved} /></Section>
      <Section title={t("Use a controller in a plan")} label="use"><UseController key={saved} controller={saved} /></Section>
    </>
  );
}
