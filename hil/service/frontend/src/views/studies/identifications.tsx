// Identifications: from runs with chirps or multisines to a model; measured and fitted responses, intervals.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import { post } from "../../api/client.ts";
import type { Identification, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { figure, significant, wordsOf } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { roleOf } from "../../plot/frame.ts";
import { CurvePlot, type Curve, type Values } from "../../plot/curve-plot.tsx";
import { go, useQuery } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Badge, Heading, inWords, Loaded, Scroll, Section } from "../../ui/parts.tsx";
import { KeepModel } from "./keep-model.tsx";
import { Chains, nameOfOrder, Orders, type Order } from "./orders.tsx";
import { ChooseRecordings, ChooseRuns, EXCITED, StudyList, StudyPage } from "./study-parts.tsx";
import { runsFrom } from "./chosen-runs.ts";

export function Identifications(): JSX.Element {
  const may = useMay();
  return (
    <>
      <Heading>{t("Identifications")}</Heading>
      {may("engineer") ? <Begin /> : null}
      <Section title={t("All identifications")} label="all"><StudyList kind="identification" /></Section>
    </>
  );
}

function Begin(): JSX.Element {
  const [query] = useQuery();
  const [runs, setRuns] = useState(() => runsFrom(query.get("runs"))), [recordings, setRecordings] = useState(() => runsFrom(query.get("recordings")));
  const begin = async (event: Event) => {
    event.preventDefault();
    const study = await attempt(() => post<Study>("/identifications", { runs, recordings }));
    if (study) go(to.identification(study.id));
  };
  return (
    <form class="card" onSubmit={(event) => void begin(event)}>
      <h2>{t("Identify a model")}</h2>
      <ChooseRuns legend={t("Runs with chirps or multisines")} from={EXCITED} chosen={runs} onChange={setRuns} />
      <ChooseRecordings legend={t("Given recordings with chirps or multisines")} chosen={recordings} onChange={setRecordings} />
      <button type="submit" class="main" disabled={!runs.length && !recordings.length}>{t("Identify")}</button>
    </form>
  );
}

export function IdentificationView({ id }: { id: number }): JSX.Element {
  return <StudyPage id={id} kind="identification">{(study) => <Result study={study} />}</StudyPage>;
}

function Result({ study }: { study: Study }): JSX.Element | null {
  const done = (study.files ?? []).includes("identification.json");
  const found = useData<Identification>(done ? `/identifications/${study.id}` : null);
  if (!done) return null;
  return <Loaded of={found} what={t("the identification")}>{(data) => <Identified data={data} />}</Loaded>;
}

function Identified({ data }: { data: Identification }): JSX.Element {
  const { verdict, warnings, resonance_hz: resonance, chain, orders, chains } = data;
  const [file, setFile] = useState(chain ? "physical.toml" : "model.toml");
  const order = orders.find((one) => one.model === file && one.responses.length) ?? null;
  return (
    <>
      <p><Badge kind={verdict} /> {[chain ? t("a chain fits the data: {chain}", { chain: inWords(chain) }) : t("no chain fits the data"), resonance ? t("resonance {frequency}", { frequency: figure(resonance, "Hz") }) : ""].filter(Boolean).join(", ")}</p>
      {warnings.map((one) => <p class="bad" key={one}><English>{one}</English></p>)}
      <KeepModel study={data.study} file={file} what={t("model")} />
      <Section title={t("Responses to the motor torque")} label="responses"><Responses data={data} order={order && !order.chosen ? order : null} /></Section>
      <Section title={t("Parameters")} label="parameters"><Parameters of={data.parameters} /></Section>
      <Section title={t("Orders side by side")} label="orders"><Orders orders={orders} file={file} onChoose={setFile} /></Section>
      {chains.length ? <Section title={t("Chains side by side")} label="chains"><Chains chains={chains} file={file} onChoose={setFile} /></Section> : null}
    </>
  );
}

// The order that is looked at beside the one that was taken.
function Responses({ data, order }: { data: Identification; order: Order | null }): JSX.Element {
  const { frequency_hz: hz, outputs } = data;
  const x = useMemo(() => hz.map((one) => one ?? 0), [hz]);
  const coherence = useMemo((): Curve[] => outputs.map((one, at) => ({ name: wordsOf(one.channel), role: roleOf(at), x, y: one.coherence })), [outputs, x]);
  return (
    <div class="plots">
      {outputs.map((output) => <Response key={output.channel} output={output} x={x} order={order} />)}
      <CurvePlot title={t("Coherence")} label={t("Coherence of every output with the motor torque")} curves={coherence} x={{ unit: "Hz", log: true }} y={{ unit: "", low: 0, high: 1.05 }} />
    </div>
  );
}

const MEASURED = { name: t("measured, 95 %"), role: roleOf(1), looks: "dots" } as const;
const FIT = { name: t("fit, 95 %"), role: roleOf(0) };
type Output = Identification["outputs"][number];

function Response({ output, x, order }: { output: Output; x: number[]; order: Order | null }): JSX.Element {
  const name = wordsOf(output.channel), other = order?.responses.find((one) => one.channel === output.channel) ?? null;
  const [gain, phase] = useMemo((): [Curve[], Curve[]] => {
    const beside = (y: Values | undefined): Curve[] => (order && y ? [{ name: nameOfOrder(order), role: roleOf(2), looks: "dashes", x, y }] : []);
    return [
      [{ ...MEASURED, x, y: output.gain_db, reach: { lower: output.gain_lower_db, upper: output.gain_upper_db } }, { ...FIT, x, y: output.fit_gain_db, reach: { lower: output.fit_gain_lower_db, upper: output.fit_gain_upper_db } }, ...beside(other?.gain_db)],
      [{ ...MEASURED, x, y: output.phase_deg, reach: { lower: output.phase_lower_deg, upper: output.phase_upper_deg } }, { ...FIT, x, y: output.fit_phase_deg, reach: { lower: output.fit_phase_lower_deg, upper: output.fit_phase_upper_deg } }, ...beside(other?.phase_deg)],
    ];
  }, [output, x, other]);
  return (
    <>
      <CurvePlot title={t("Gain to {name}", { name })} label={t("Gain from motor torque to {name}, measured and fitted", { name })} curves={gain} x={{ unit: "Hz", log: true }} y={{ unit: "dB" }} />
      <CurvePlot title={t("Phase to {name}", { name })} label={t("Phase from motor torque to {name}, measured and fitted", { name })} curves={phase} x={{ unit: "Hz", log: true }} y={{ unit: "°" }} />
    </>
  );
}

// Five digits: intervals of a good identification differ in the fourth.
const digits = (value: number | null): string => (value === null ? "–" : significant(value, 5));

function Parameters({ of }: { of: Identification["parameters"] }): JSX.Element {
  return (
    <Scroll label={t("Parameters of the model")}><table>
      <thead><tr><th scope="col">{t("parameter")}</th><th scope="col" class="number">{t("value")}</th><th scope="col" class="number">{t("95 % interval")}</th><th scope="col">{t("unit")}</th></tr></thead>
      <tbody>{of.map((one) => <tr key={one.name}><th scope="row">{inWords(one.name)}</th><td class="number">{digits(one.value)}</td><td class="number">{one.lower === null ? t("not known") : t("{lower} to {upper}", { lower: digits(one.lower), upper: digits(one.upper) })}</td><td>{one.unit}</td></tr>)}</tbody>
    </table></Scroll>
  );
}
