// What identifications and diagnoses have in common: their list, runs to choose, how one goes, what it has left.

import type { ComponentChildren, JSX } from "preact";
import { API, ask, getText, post } from "../../api/client.ts";
import type { Run, Study } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Badge, Facts, FileLink, Heading, Loaded, Moment, Scroll, Section } from "../../ui/parts.tsx";
import { useRecordings } from "../recordings/recordings.tsx";

const AGAIN_MS = 2000;
const MOST_RUNS = 12;
export const OVER = ["ended", "failed", "cancelled", "interrupted"];
type Kind = Study["kind"];

const listOf = (kind: Kind) => (kind === "diagnosis" ? "diagnoses" : "identifications");
const addressOf = (study: Study): string => (study.kind === "diagnosis" ? to.diagnosis(study.id) : to.identification(study.id));

export function StudyList({ kind }: { kind: Kind }): JSX.Element {
  const studies = useData<Study[]>(`/studies?kind=${kind}`, AGAIN_MS), isDiagnosis = kind === "diagnosis";
  return (
    <Loaded of={studies} what={listOf(kind)}>
      {(all) => all.length ? (
        <Scroll label={isDiagnosis ? "Diagnoses" : "Identifications"}><table>
          <thead><tr><th scope="col" class="number">number</th><th scope="col">state</th>{isDiagnosis ? <th scope="col">model</th> : null}<th scope="col">runs</th><th scope="col">asked for</th><th scope="col">by</th></tr></thead>
          <tbody>{all.map((one) => <tr key={one.id}><td class="number"><a href={addressOf(one)}>{one.id}</a></td><td><Badge kind={one.state} />{one.reason ? <span class="reason">{one.reason}</span> : null}</td>{isDiagnosis ? <td>{one.model}</td> : null}<td><RunLinks runs={one.runs} /><RecordingLinks recordings={one.recordings ?? []} /></td><td><Moment at={one.asked_at} /></td><td>{one.requested_by}</td></tr>)}</tbody>
        </table></Scroll>
      ) : <p class="quiet">None yet.</p>}
    </Loaded>
  );
}

const RunLinks = ({ runs }: { runs: number[] }): JSX.Element => <span class="links">{runs.map((run) => <a key={run} href={to.run(run)}>{run}</a>)}</span>;

const RecordingLinks = ({ recordings }: { recordings: number[] }): JSX.Element => <span class="links">{recordings.map((one) => <a key={one} href={to.recording(one)}>{t("recording {number}", { number: one })}</a>)}</span>;

// The newest runs with recordings, and those that the address names, to be ticked.
export function ChooseRuns({ legend, chosen, onChange, without = [] }: { legend: string; chosen: number[]; onChange: (runs: number[]) => void; without?: number[] }): JSX.Element {
  const all = useData<Run[]>("/runs?most=100&state=ended&state=interrupted", 10_000);
  const recorded = (all.data ?? []).filter((run) => (run.files ?? []).includes("recording.mcap") && !without.includes(run.id));
  const offered = recorded.filter((run, at) => at < MOST_RUNS || chosen.includes(run.id));
  const others = chosen.filter((id) => !offered.some((run) => run.id === id));
  const turn = (id: number, on: boolean) => onChange(on ? [...chosen, id] : chosen.filter((one) => one !== id));
  const tick = (id: number, name: string) => (
    <label class="tick" key={id}><input type="checkbox" checked={chosen.includes(id)} onChange={(event) => turn(id, event.currentTarget.checked)} />{name}</label>
  );
  return (
    <fieldset class="ticks"><legend>{legend}</legend>
      {others.map((id) => tick(id, `run ${id}`))}
      {offered.map((run) => tick(run.id, `run ${run.id}: ${run.title || run.plan}, ${run.bench}`))}
      {all.data && !offered.length && !others.length ? <p class="quiet">There is no recording yet.</p> : null}
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
  return <Loaded of={study} what={`${kind} ${id}`}>{(found) => <Found study={found}>{children(found)}</Found>}</Loaded>;
}

function Found({ study, children }: { study: Study; children: ComponentChildren }): JSX.Element {
  const may = useMay(), isOver = OVER.includes(study.state), files = study.files ?? [];
  const remove = async () => {
    if (!confirm(`Remove ${study.kind} ${study.id} with its files?`)) return;
    if (await attempt(async () => { await ask("DELETE", `/studies/${study.id}`); return true; })) go(to.list(listOf(study.kind)));
  };
  return (
    <>
      <Heading kind={<a href={to.list(listOf(study.kind))}>{study.kind === "diagnosis" ? "Diagnoses" : "Identifications"}</a>}>{`${study.kind === "diagnosis" ? "Diagnosis" : "Identification"} ${study.id} `}<Badge kind={study.state} /></Heading>
      <StudyFacts study={study} />
      {may("engineer") && !study.place ? (
        <div class="row">
          {isOver ? <button type="button" onClick={() => void remove()}>Remove</button> : <button type="button" onClick={() => void attempt(() => post(`/studies/${study.id}/cancel`))}>Cancel</button>}
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
  const link = (name: string) => <FileLink key={name} name={name} href={fileOf(study, name)}>{name === "report.html" ? `report of the ${study.kind}` : name}</FileLink>;
  return (
    <Section title="Files" label="files">
      <p class="links">{others.map(link)}</p>
      {figures.length ? <details><summary>{`${figures.length} figures`}</summary><p class="links">{figures.map(link)}</p></details> : null}
    </Section>
  );
}

const fileOf = (study: Study, name: string): string => `${API}/studies/${study.id}/files/${encodeURIComponent(name)}`;
export const textOf = (study: Study, name: string): Promise<string> => getText(`/studies/${study.id}/files/${encodeURIComponent(name)}`);

function StudyFacts({ study }: { study: Study }): JSX.Element {
  const facts: ([string, ComponentChildren] | null)[] = [
    study.runs.length ? ["runs", <RunLinks runs={study.runs} />] : null,
    study.recordings?.length ? [t("recordings"), <RecordingLinks recordings={study.recordings} />] : null,
    study.model ? ["model", <a href={to.model(study.model)}>{study.model}</a>] : null,
    ["asked for by", study.requested_by], ["asked for", <Moment at={study.asked_at} />],
    study.ended_at ? ["ended", <Moment at={study.ended_at} />] : null,
    study.reason ? ["reason", study.reason] : null, study.place ? ["at", study.place] : null,
  ];
  return <Facts>{facts.filter((one) => one !== null)}</Facts>;
}
