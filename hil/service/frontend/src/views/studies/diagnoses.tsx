// Diagnoses: why runs and a model differ; begun here, and what came of one.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Diagnosis, Model, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { go, useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { NumberInput } from "../../ui/number-field.tsx";
import { Heading, Loaded, Section } from "../../ui/parts.tsx";
import { runsFrom } from "./chosen-runs.ts";
import { Alternatives, Effects } from "./effects.tsx";
import { ErrorMap, Gaps } from "./gaps.tsx";
import { isImproved } from "./improved.ts";
import { KeepModel } from "./keep-model.tsx";
import { ChooseRecordings, ChooseRuns, StudyList, StudyPage } from "./study-parts.tsx";

export function Diagnoses(): JSX.Element {
  const may = useMay();
  return (
    <>
      <Heading>{t("Diagnoses")}</Heading>
      {may("engineer") ? <Begin /> : null}
      <Section title={t("All diagnoses")} label="all"><StudyList kind="diagnosis" /></Section>
    </>
  );
}

function Begin(): JSX.Element {
  const [query] = useQuery();
  const models = (useData<Model[]>("/models").data ?? []).filter((one) => one.kind !== "transfer_function");
  const [runs, setRuns] = useState(() => runsFrom(query.get("runs"))), [holdout, setHoldout] = useState<number[]>([]);
  const [recordings, setRecordings] = useState(() => runsFrom(query.get("recordings"))), [heldRecordings, setHeldRecordings] = useState<number[]>([]);
  const [chosen, setModel] = useState(query.get("model") ?? ""), [minutes, setMinutes] = useState("10");
  const model = chosen || models[0]?.name || "";
  const begin = async (event: Event) => {
    event.preventDefault();
    const study = await attempt(() => post<Study>("/diagnoses", { model, runs, recordings, holdout, holdout_recordings: heldRecordings, at_most_min: Number(minutes) }));
    if (study) go(to.diagnosis(study.id));
  };
  return (
    <form class="card" onSubmit={(event) => void begin(event)}>
      <h2>{t("Find what a model lacks")}</h2>
      <div class="row">
        <label class="field">{t("Model")}<select value={model} onChange={(event) => setModel(event.currentTarget.value)}>{models.map((one) => <option key={one.name}>{one.name}</option>)}</select></label>
        <label class="field">{t("Time limit, minutes")}<NumberInput min={0.1} max={60} required value={minutes} onText={setMinutes} /></label>
      </div>
      <div class="halves">
        <ChooseRuns legend={t("Runs to compare with the model")} chosen={runs} onChange={setRuns} without={holdout} />
        <ChooseRuns legend={t("Runs held out, for validation")} chosen={holdout} onChange={setHoldout} without={runs} />
        <ChooseRecordings legend={t("Given recordings to compare with the model")} chosen={recordings} onChange={setRecordings} without={heldRecordings} />
        <ChooseRecordings legend={t("Given recordings held out, for validation")} chosen={heldRecordings} onChange={setHeldRecordings} without={recordings} />
      </div>
      <button type="submit" class="main" disabled={!(runs.length || recordings.length) || !model}>{t("Diagnose")}</button>
    </form>
  );
}

export function DiagnosisView({ id }: { id: number }): JSX.Element {
  return <StudyPage id={id} kind="diagnosis">{(study) => <Result study={study} />}</StudyPage>;
}

function Result({ study }: { study: Study }): JSX.Element | null {
  const done = (study.files ?? []).includes("diagnosis.json");
  const found = useData<Diagnosis>(done ? `/diagnoses/${study.id}` : null);
  if (!done) return null;
  return <Loaded of={found} what={t("the diagnosis")}>{(data) => <Found data={data} />}</Loaded>;
}

function Found({ data }: { data: Diagnosis }): JSX.Element {
  const hasHoldout = Object.keys(data.holdout_gap).length > 0;
  return (
    <>
      <Effects of={data} />
      {data.alternatives.length ? <Alternatives of={data} /> : null}
      <Section title={t("Error over noise, before → after")} label="map"><ErrorMap of={data.map} /></Section>
      <Section title={t("Gap, % of the signal")} label="gap"><Gaps of={data.gap} label={t("Gap")} /></Section>
      {hasHoldout ? <Section title={t("Gap on runs that were held out")} label="holdout"><Gaps of={data.holdout_gap} label={t("Gap of held-out runs")} /></Section> : null}
      {isImproved(data) ? <KeepModel study={data.study} file="model.toml" what={t("improved model")} /> : <p class="quiet">{t("Nothing improved: no effect was named, and no gap is smaller than with the model as it is.")}</p>}
    </>
  );
}
