// Diagnoses, and identifications beside them: what was found, and what the model lacks.

import type { JSX } from "preact";
import { ask, post, API } from "../api/client.ts";
import type { Diagnosis, Study } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt, useData } from "../data.ts";
import { figure, percent } from "../format.ts";
import { go } from "../router.ts";
import { useMay } from "../session.ts";
import { Badge, Facts, Heading, inWords, Loaded, Moment, Scroll, Section } from "../ui/parts.tsx";
import { FormerPage } from "./former-page.tsx";

const AGAIN_MS = 3000;
const OVER = ["ended", "failed", "cancelled", "interrupted"];

export function Studies(): JSX.Element {
  const studies = useData<Study[]>("/studies", AGAIN_MS);
  return (
    <>
      <Heading>Diagnoses</Heading>
      <FormerPage what="Diagnose runs, or identify a model" role="engineer" />
      <Loaded of={studies} what="studies">
        {(all) => all.length ? (
          <Scroll label="Studies"><table>
            <thead><tr><th scope="col" class="number">number</th><th scope="col">kind</th><th scope="col">state</th><th scope="col">model</th><th scope="col">runs</th><th scope="col">asked for</th><th scope="col">by</th></tr></thead>
            <tbody>{all.map((one) => <tr key={one.id}><td class="number"><a href={to.diagnosis(one.id)}>{one.id}</a></td><th scope="row">{one.kind}</th><td><Badge kind={one.state} /></td><td>{one.model || "–"}</td><td>{one.runs.map((run) => <a key={run} href={to.run(run)}>{`${run} `}</a>)}</td><td><Moment at={one.asked_at} /></td><td>{one.requested_by}</td></tr>)}</tbody>
          </table></Scroll>
        ) : <p class="quiet">None yet.</p>}
      </Loaded>
    </>
  );
}

export function StudyView({ id }: { id: number }): JSX.Element {
  const study = useData<Study>(`/studies/${id}`, AGAIN_MS);
  return <Loaded of={study} what={`study ${id}`}>{(found) => <Found study={found} />}</Loaded>;
}

function Found({ study }: { study: Study }): JSX.Element {
  const may = useMay(), isOver = OVER.includes(study.state), files = study.files ?? [];
  const isDiagnosis = study.kind === "diagnosis" && files.includes("diagnosis.json");
  const diagnosis = useData<Diagnosis>(isDiagnosis ? `/diagnoses/${study.id}` : null);
  const remove = async () => {
    if (!confirm(`Remove this ${study.kind} with its files?`)) return;
    if (await attempt(async () => { await ask("DELETE", `/studies/${study.id}`); return true; })) go(to.list("diagnoses"));
  };
  return (
    <>
      <Heading kind={inWords(study.kind)}>{`${study.kind === "diagnosis" ? "Diagnosis" : "Identification"} ${study.id} `}<Badge kind={study.state} /></Heading>
      <Facts>
        {([["runs", study.runs.map((run) => <a key={run} href={to.run(run)}>{`${run} `}</a>)], study.model ? ["model", <a href={to.model(study.model)}>{study.model}</a>] : null, ["asked for by", study.requested_by], ["asked for", <Moment at={study.asked_at} />], study.ended_at ? ["ended", <Moment at={study.ended_at} />] : null, study.reason ? ["reason", study.reason] : null, study.place ? ["at", study.place] : null] as ([string, JSX.Element] | null)[]).filter((one) => one !== null)}
      </Facts>
      {files.length ? <Section title="Files" label="files"><p class="links">{files.map((name) => <a key={name} href={`${API}/studies/${study.id}/files/${encodeURIComponent(name)}`} target="_blank" rel="noopener">{name}</a>)}</p></Section> : null}
      {isDiagnosis ? <Loaded of={diagnosis} what="the diagnosis">{(found) => <Named of={found} />}</Loaded> : null}
      {may("engineer") && !study.place ? (
        <div class="row">
          {isOver ? <button type="button" onClick={() => void remove()}>Remove</button> : <button type="button" onClick={() => void attempt(() => post(`/studies/${study.id}/cancel`))}>Cancel</button>}
        </div>
      ) : null}
    </>
  );
}

function Named({ of }: { of: Diagnosis }): JSX.Element {
  return (
    <>
      <Section title={<>Effects that the model lacks <Badge kind={of.verdict} /></>} label="effects">
        {of.unfinished ? <p>{`Unfinished: ${of.unfinished}`}</p> : null}
        {of.effects.map((one) => <p key={one.id}><b>{inWords(one.id)}</b>{` (${typeof one.confidence === "number" ? percent(one.confidence) : one.confidence}): ${Object.entries(one.parameters).map(([name, value]) => `${name} = ${typeof value === "number" ? figure(value) : value}`).join(", ")}; seen in ${one.channels.join(", ")}`}</p>)}
        {of.alternatives.map((one) => <p key={one.id} class="quiet">{`${inWords(one.id)} is possible, too; test to distinguish them: ${one.separating_test}`}</p>)}
        {[of.remaining_gap, ...of.notes].filter(Boolean).map((text) => <p key={text} class="quiet">{text}</p>)}
      </Section>
      <Section title="Gap between model and bench" label="gap">
        <Scroll label="Gap"><table>
          <thead><tr><th scope="col">channel</th><th scope="col" class="number">before</th><th scope="col" class="number">after</th><th scope="col" class="number">noise</th></tr></thead>
          <tbody>{Object.entries(of.gap).map(([name, one]) => <tr key={name}><th scope="row">{name}</th>{[one.before, one.after, one.noise_floor].map((share, at) => <td key={at} class="number">{share == null ? "–" : percent(share, 1)}</td>)}</tr>)}</tbody>
        </table></Scroll>
      </Section>
    </>
  );
}
