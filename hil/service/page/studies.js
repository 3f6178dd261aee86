// What identifications and diagnoses have in common: runs to choose, one to show, and how it goes.

import { ask, get, post } from "./api.js";
import { at, badge, offer, said } from "./dom.js";

const LOOK_MS = 1500;
const MOST_RUNS = 12;
const OVER = ["ended", "failed", "cancelled", "interrupted"];

// The newest runs with recordings, to be ticked.
export async function offerRuns(field, bench) {
  const all = await get(`/runs?bench=${encodeURIComponent(bench)}&most=100&state=ended&state=interrupted`);
  const runs = all.filter((run) => run.files.includes("recording.mcap")).slice(0, MOST_RUNS);
  const ticked = chosenRuns(field);
  field.querySelectorAll("label, p").forEach((one) => one.remove());
  if (!runs.length) field.append(said("There is no recording yet.", "quiet"));
  field.append(...runs.map((run) => {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", value: run.id, checked: ticked.includes(run.id) });
    label.className = "tick";
    label.append(box, `run ${run.id}: ${run.title || run.plan}`);
    return label;
  }));
}

export const chosenRuns = (field) => [...field.querySelectorAll("input:checked")].map((one) => Number(one.value));

// kind: "identification" or "diagnosis"; show: called with what one has found
export class Studies {
  constructor(kind, id, act, show) {
    Object.assign(this, { kind, id, act, show, shown: "", timer: 0 });
    at(`${id}-study`).onchange = () => this.look();
    at(`${id}-remove`).onclick = () => this.remove(at(`${id}-study`).value);
    at(`${id}-cancel`).onclick = () => act(async () => { await post(`/studies/${at(`${id}-study`).value}/cancel`); await this.look(); });
  }

  async begin(path, body) {
    const study = await post(path, body);
    await this.look(study.id);
  }

  remove(study) {
    if (!confirm(`Remove ${this.kind} ${study} with its files?`)) return;
    this.act(async () => { await ask("DELETE", `/studies/${study}`); await this.look(); });
  }

  async look(wanted) {
    clearTimeout(this.timer);
    const all = await get(`/studies?kind=${this.kind}`);
    offer(at(`${this.id}-study`), all.map((one) => [one.id, `${one.id}: runs ${one.runs.join(", ")}${one.model ? ` and ${one.model}` : ""}, ${one.state}`]));
    if (wanted) at(`${this.id}-study`).value = wanted;
    const study = all.find((one) => String(one.id) === at(`${this.id}-study`).value);
    at(`${this.id}-row`).hidden = !study;
    at(`${this.id}-cancel`).hidden = !study || study.place !== "" || OVER.includes(study.state);
    at(`${this.id}-remove`).hidden = !study || study.place !== "" || !OVER.includes(study.state);
    at(`${this.id}-state`).replaceChildren(...(study ? [badge(study.state)] : []), [study?.place, study?.reason].filter(Boolean).map((text) => ` ${text}`).join(";"));
    const key = study ? `${study.id} ${study.state} ${study.files.length}` : "";
    if (key !== this.shown) { this.shown = key; await this.found(study); }
    if (all.some((one) => !OVER.includes(one.state))) this.timer = setTimeout(() => this.act(() => this.look()), LOOK_MS);
  }

  async found(study) {
    at(`${this.id}-found`).hidden = true;
    const made = this.kind === "identification" ? "identification.json" : "diagnosis.json";
    if (!study?.files.includes(made)) return;
    const answer = await get(`/${this.kind === "identification" ? "identifications" : "diagnoses"}/${study.id}`);
    at(`${this.id}-found`).hidden = false;
    at(`${this.id}-report`).href = `/api/v1/studies/${study.id}/files/report.html`;
    this.show(answer);
  }
}

export async function saveModel(study, file, name) {
  const text = await ask("GET", `/studies/${study.id}/files/${file}`, undefined, true);
  await ask("PUT", `/models/${name}`, text);
}
