// What identifications and diagnoses have in common: their list, runs to choose, how one goes, what it has left.

import type { ComponentChildren, JSX } from "preact";
import { API, ask, getText, post } from "../../api/client.ts";
import type { Run, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, isMissing, useData } from "../../data.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { kindInWords } from "../../ui/kinds.ts";
import { Badge, Facts, FileLink, Heading, Loaded, Moment, Scroll, Section } from "../../ui/parts.tsx";
import { NoneThere } from "../none-there.tsx";
import { nameOf } from "../runs/run-name.ts";
import { useRecordings } from "../recordings/recordings.tsx";

const AGAIN_MS = 2000;
const MOST_RUNS = 12;
export const OVER = ["ended", "failed", "cancelled", "interrupted"];
type Kind = Study["kind"];

const listOf = (kind: Kind) => (kind === "diagnosis" ? "diagnoses" : kind === "identification" ? "identifications" : "tunings");
const addressOf = (study: Study): string => (study.kind === "diagnosis" ? to.diagnosis(study.id) : to.identification(study.id));

export function StudyList({ kind }: { kind: Kind }): JSX.Element {
  const studies = useData<Study[]>(`/studies?kind=${kind}`, AGAIN_MS), isDiagnosis = kind === "diagnosis";
  return (
    <Loaded of={studies} what={kind === "diagnosis" ? t("diagnoses") : t("identifications")}>
      {(all) => all.length ? (
        <Scroll label={isDiagnosis ? t("Diagnoses") : t("Identifications")}><table>
          <thead><tr><th scope="col" class="number">{t("number")}</th><th scope="col">{t("state")}</th>{isDiagnosis ? <th scope="col">{t("model")}</th> : null}<th scope="col">{t("runs")}</th><th scope="col">{t("asked for")}</th><th scope="col">{t("by")}</th></tr></thead>
          <tbody>{all.map((one) => <tr key={one.id}><td class="number"><a href={addressOf(one)}>{one.id}</a></td><td><Badge kind={one.state} />{one.reason ? <span class="reason"><English>{one.reason}</English></span> : null}</td>{isDiagnosis ? <td>{one.model}</td> : null}<td><RunLinks runs={one.runs} /><RecordingLinks recordings={one.recordings ?? []} /></td><td><Moment at={one.asked_at} /></td><td>{one.requested_by}</td></tr>)}</tbody>
        </table></Scroll>
      ) : <p class="quiet">{isDiagnosis ? t("None yet. A diagnosis compares runs or recordings with a model.") : t("None yet. A model is identified from runs or recordings with steps.")}</p>}
    </Loaded>
  );
}

const RunLinks = ({ runs }: { runs: number[] }): JSX.Element => <span class="links">{runs.map((run) => <a key={run} href={to.run(run)}>{run}</a>)}</span>;

const RecordingLinks = ({ recordings }: { recordings: number[] }): JSX.Element => <span class="links">{recordings.map((one) => <a key={one} href={to.recording(one)}>{t("recording {number}", { number: one })}</a>)}</span>;

const RECORDED = "/runs?most=100&state=ended&state=interrupted";
// Those that a response can be measured from: their plans excite all frequencies, and they went on to their end.
export const EXCITED = "/runs?most=100&state=ended&verdict=pass&verdict=fail&verdict=done&step=chirp&step=multisine";

// The newest runs with recordings, and those that the address names, to be ticked.
export function ChooseRuns({ legend, chosen, onChange, without = [], from = RECORDED }: { legend: string; chosen: number[]; onChange: (runs: number[]) => void; without?: number[]; from?: string }): JSX.Element {
  const all = useData<Run[]>(from, 10_000);
  const recorded = (all.data ?? []).filter((run) => (run.files ?? []).includes("recording.mcap") && !without.includes(run.id));
  const offered = recorded.filter((run, at) => at < MOST_RUNS || chosen.includes(run.id));
  const others = chosen.filter((id) => !offered.some((run) => run.id === id));
  const turn = (id: number, on: boolean) => onChange(on ? [...chosen, id] : chosen.filter((one) => one !== id));
  const tick = (id: number, name: string) => (
    <label class="tick" key={id}><input type="checkbox" checked={chosen.includes(id)} onChange={(event) => turn(id, event.currentTarget.checked)} />{name}</label>
  );
  return (
    <fieldset class="ticks"><legend>{legend}</legend>
      {others.map((id) => tick(id, t("run {run}", { run: id })))}
      {offered.map((run) => tick(run.id, t("run {run}: {plan}, {bench}", { run: run.id, plan: nameOf(run), bench: run.bench })))}
      {all.data && !offered.length && !others.length ? <p class="quiet">{from === EXCITED ? t("No run of a plan with a chirp or a multisine has ended yet.") : t("There is no recording yet.")}</p> : null}
    </fieldset>
  );
}

// Recordings that people gave and that are ready, to be ticked.
export function ChooseRecordings({ legend, chosen, onChange, without = [] }: { legend: string; chosen: number[]; onChange: (recordings: number[]) => void; without?: number[] }): JSX.Element {
  const all = useRecordings();
  const offered = (all.data ?? []).filter((one) => one.state === "ready" && !without.includes(one.id));
  const turn = (id: number, on: boolean) => onChange(on ? [...chosen, id] : chosen.filter((one) => one !== id));
  return (
    <fieldset class="ticks"><legend>{legend}</legend>
      {offered.map((one) => <label class="tick" key={one.id}><input type="checkbox" checked={chosen.includes(one.id)} onChange={(event) => turn(one.id, event.currentTarget.checked)} />{t("recording {number}: {name}", { number: one.id, name: one.name })}</label>)}
      {all.data && !offered.length ? <p class="quiet"><a href={to.list("recordings")}>{t("Give a recording")}</a></p> : null}
    </fieldset>
  );
}

export function StudyPage({ id, kind, children }: { id: number; kind: Kind; children: (study: Study) => ComponentChildren }): JSX.Element {
  const study = useData<Study>(`/studies/${id}`, AGAIN_MS);
  if (isMissing(study)) return <NoneThere kind={kind === "diagnosis" || kind === "identification" ? kind : "tuning"} name={id} />;
  return <Loaded whole of={study} what={`${kindInWords(kind)} ${id}`}>{(found) => <Found study={found}>{children(found)}</Found>}</Loaded>;
}

function titleOf({ kind, id: number }: Study): string {
  if (kind === "diagnosis") return t("Diagnosis {number}", { number });
  return kind === "identification" ? t("Identification {number}", { number }) : t("Tuning {number}", { number });
}

function questionOf({ kind, id: number }: Study): string {
  if (kind === "diagnosis") return t("Remove diagnosis {number} with its files?", { number });
  return kind === "identification" ? t("Remove identification {number} with its files?", { number }) : t("Remove tuning {number} with its files?", { number });
}

function Found({ study, children }: { study: Study; children: ComponentChildren }): JSX.Element {
  const may = useMay(), isOver = OVER.includes(study.state), files = study.files ?? [];
  const remove = async () => {
    if (!(await agreed(questionOf(study), t("Remove"), t("Cancel")))) return;
    if (await attempt(async () => { await ask("DELETE", `/studies/${study.id}`); return true; })) go(to.list(listOf(study.kind)));
  };
  return (
    <>
      <Heading kind={<a href={to.list(listOf(study.kind))}>{study.kind === "diagnosis" ? t("Diagnoses") : study.kind === "identification" ? t("Identifications") : t("Tunings")}</a>}>{titleOf(study)} <Badge kind={study.state} /></Heading>
      <StudyFacts study={study} />
      {may("engineer") && !study.place ? (
        <div class="row">
          {isOver ? <button type="button" onClick={() => void remove()}>{t("Remove")}</button> : <button type="button" onClick={() => void attempt(() => post(`/studies/${study.id}/cancel`))}>{t("Cancel")}</button>}
        </div>
      ) : null}
      {children}
      {files.length ? <Files study={study} names={files} /> : null}
    </>
  );
}

function Files({ study, names }: { study: Study; names: string[] }): JSX.Element {
  const figures = names.filter((name) => /\.(png|svg)$/.test(name)), first = (name: string) => (name.startsWith("report") ? 0 : 1);
  const others = names.filter((name) => !figures.includes(name)).sort((one, other) => first(one) - first(other));
  const link = (name: string) => <FileLink key={name} name={name} href={fileOf(study, name)}>{name === "report.html" ? t("report of the {kind}", { kind: kindInWords(study.kind) }) : name}</FileLink>;
  return (
    <Section title={t("Files")} label="files">
      <p class="links">{others.map(link)}</p>
      {figures.length ? <details><summary>{tn("{count} figure", "{count} figures", figures.length)}</summary><p class="links">{figures.map(link)}</p></details> : null}
    </Section>
  );
}

const fileOf = (study: Study, name: string): string => `${API}/studies/${study.id}/files/${encodeURIComponent(name)}`;
export const textOf = (study: Study, name: string): Promise<string> => getText(`/studies/${study.id}/files/${encodeURIComponent(name)}`);

function StudyFacts({ study }: { study: Study }): JSX.Element {
  const facts: ([string, ComponentChildren] | null)[] = [
    study.runs.length ? [t("runs"), <RunLinks runs={study.runs} />] : null,
    study.recordings?.length ? [t("recordings"), <RecordingLinks recordings={study.recordings} />] : null,
    study.model ? [t("model"), <a href={to.model(study.model)}>{study.model}</a>] : null,
    study.plan ? [t("plan"), <a href={to.plan(study.plan)}>{study.plan}</a>] : null, study.bench ? [t("bench"), <a href={to.bench(study.bench)}>{study.bench}</a>] : null,
    [t("asked for by"), study.requested_by], [t("asked for"), <Moment at={study.asked_at} />],
    study.ended_at ? [t("ended"), <Moment at={study.ended_at} />] : null,
    study.reason ? [t("reason"), <English>{study.reason}</English>] : null, study.place ? [t("on service"), study.place] : null,
  ];
  return <Facts>{facts.filter((one) => one !== null)}</Facts>;
}
