// Why runs and a model differ: the map, the name, the shrink, and the test that tells names apart.

import { ask, get, post } from "./api.js";
import { at, badge, cell, offer, row, said, whenOpened } from "./dom.js";
import { listModels } from "./design.js";
import { number } from "./frame.js";
import { Studies, chosenRuns, offerRuns, saveModel } from "./studies.js";

const percent = (share) => `${Number((100 * share).toPrecision(3))} %`;
let found = null, act = null, bench = null, engineer = false;

export function beginDiagnosis(ofBench, does, may) {
  [bench, act, engineer] = [ofBench, does, may];
  const studies = new Studies("diagnosis", "diagnose", act, show);
  at("diagnose-wanted").hidden = !may;
  at("diagnose-save").hidden = !may;
  whenOpened(at("diagnose"), () => act(() => studies.look()));
  at("diagnose").addEventListener("toggle", () => { if (at("diagnose").open) act(choices); });
  if (at("diagnose").open) act(choices);
  at("diagnose-wanted").onsubmit = (event) => {
    event.preventDefault();
    const body = { model: at("diagnose-model").value, runs: chosenRuns(at("diagnose-runs")), at_most_min: Number(at("diagnose-minutes").value) };
    act(() => studies.begin("/diagnoses", body));
  };
  at("diagnose-save").onsubmit = (event) => { event.preventDefault(); act(save); };
}

async function choices() {
  await offerRuns(at("diagnose-runs"), bench());
  const models = await get("/models");
  offer(at("diagnose-model"), models.filter((one) => one.kind !== "transfer_function").map((one) => [one.name, one.name]));
}

async function save() {
  const name = at("diagnose-name").value;
  await saveModel(found.study, "model.toml", name);
  at("diagnose-message").textContent = `Saved as ${name}.`;
  await listModels();
  await choices();
}

function show(answer) {
  found = answer;
  const { verdict, unfinished, effects, alternatives, gap, remaining_gap: left, notes } = found;
  at("diagnose-verdict").replaceChildren(badge(verdict), unfinished ? ` unfinished: ${unfinished}` : "");
  const named = effects.map((one) => {
    const values = Object.entries(one.parameters).map(([name, value]) => `${name} = ${typeof value === "number" ? Number(value.toPrecision(4)) : value}${one.standard_error[name] ? ` ± ${Number(one.standard_error[name].toPrecision(2))}` : ""}`);
    return said(`${one.id.replaceAll("_", " ")} (${percent(one.confidence)}): ${values.join(", ")}; seen in ${one.channels.join(", ")}, ${one.band_hz.join(" to ")} Hz, ${one.condition}`);
  });
  at("diagnose-names").replaceChildren(...named, ...[left, ...notes].filter(Boolean).map((one) => said(one, "quiet")));
  at("diagnose-gaps").tBodies[0].replaceChildren(...Object.entries(gap).map(([name, one]) => row(cell(name, "", "th"), ...[one.before, one.after, one.noise_floor].map((share) => cell(percent(share), "number")))));
  at("diagnose-others").hidden = alternatives.length === 0;
  at("diagnose-alternatives").replaceChildren(...alternatives.map(alternative));
  map(found.map);
}

function alternative(one) {
  const made = document.createElement("li"), text = document.createElement("span");
  text.textContent = `${one.id.replaceAll("_", " ")} (${percent(one.confidence)}); test to distinguish them: ${one.separating_test}`;
  made.append(text);
  if (one.plan && engineer && found.study.files.includes(one.plan)) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: "Run the separating test" });
    button.setAttribute("aria-label", `Run the separating test for ${one.id.replaceAll("_", " ")}`);
    button.onclick = () => act(() => separate(one.plan));
    made.append(" ", button);
  }
  return made;
}

async function separate(file) {
  const text = await ask("GET", `/studies/${found.study.id}/files/${file}`, undefined, true);
  const name = text.match(/^name:\s*["']?([A-Za-z0-9_.-]+)/m)[1];
  await ask("PUT", `/plans/${name}`, text);
  const run = await post("/runs", { plan: name, bench: bench() });
  at("diagnose-message").textContent = `Run ${run.id} is queued: ${run.title || name}.`;
}

// The worst recording of each channel and band; a colour's strength goes with the logarithm of error over noise.
function map({ channels, bands_hz: bands, before, after }) {
  const worst = (table, channel, band) => Math.max(...table.map((recording) => recording[channel][band] ?? -1));
  const head = document.createElement("tr");
  head.append(...["channel", ...bands.map(([low, high]) => `${low} to ${high} Hz`)].map((text, index) => Object.assign(document.createElement("th"), { scope: "col", textContent: text, className: index ? "number" : "" })));
  at("diagnose-map").tHead.replaceChildren(head);
  at("diagnose-map").tBodies[0].replaceChildren(...channels.map((name, channel) => row(cell(name, "", "th"), ...bands.map((_, band) => {
    const [old, now] = [worst(before, channel, band), worst(after, channel, band)];
    const made = cell(old < 0 ? "–" : `${number(old)} → ${number(now)}`, "number heat");
    const strength = old < 0 ? 0 : Math.min(1, Math.max(0, Math.log10(old) / 2));
    made.style.setProperty("--heat", `${Math.round(35 * strength)}%`);
    return made;
  }))));
}
