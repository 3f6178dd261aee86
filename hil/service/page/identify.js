// From a finished run to a model: measured and fitted responses, coherence, parameters with intervals.

import { at, badge, cell, redrawn, row, said, whenOpened } from "./dom.js";
import { listModels } from "./design.js";
import { Frame, colour, number } from "./frame.js";
import { Studies, chosenRuns, offerRuns, saveModel } from "./studies.js";

const CHARTS = { "fit-motor": "motor_speed_rad_s", "fit-shaft": "shaft_torque_nm" };
let found = null;

export function beginIdentification(bench, act, may) {
  const studies = new Studies("identification", "identify", act, show);
  at("identify-wanted").hidden = !may;
  at("identify-save").hidden = !may;
  whenOpened(at("identify"), () => act(async () => { await offerRuns(at("identify-runs"), bench()); await studies.look(); }));
  at("identify").addEventListener("toggle", () => { if (at("identify").open) act(() => offerRuns(at("identify-runs"), bench())); });
  at("identify-wanted").onsubmit = (event) => { event.preventDefault(); act(() => studies.begin("/identifications", { runs: chosenRuns(at("identify-runs")) })); };
  at("identify-save").onsubmit = (event) => { event.preventDefault(); act(save); };
  redrawn(draw);
}

async function save() {
  const name = at("identify-name").value;
  await saveModel(found.study, found.chain ? "physical.toml" : "model.toml", name);
  at("identify-message").textContent = `Saved as ${name}: available for design and diagnosis.`;
  await listModels();
}

function show(answer) {
  found = answer;
  const { verdict, warnings, resonance_hz: resonance, chain, parameters } = found;
  at("identify-verdict").replaceChildren(badge(verdict), ` ${chain ? `a ${chain.replaceAll("_", " ")} chain fits the data` : "no chain fits the data"}${resonance ? `, resonance ${number(resonance)} Hz` : ""}`);
  at("identify-warnings").replaceChildren(...warnings.map((one) => said(one, "bad")));
  const digits = (value) => (value === null ? "–" : Number(value.toPrecision(5)).toString().replace("-", "−"));
  at("identify-parameters").tBodies[0].replaceChildren(...parameters.map((one) => {
    const interval = one.lower === null ? "not known" : `${digits(one.lower)} to ${digits(one.upper)}`;
    return row(cell(one.name.replaceAll("_", " "), "", "th"), cell(digits(one.value), "number"), cell(interval, "number"), cell(one.unit));
  }));
  draw();
}

function draw() {
  if (!found || !at("fit-motor").clientWidth) return;
  const hz = found.frequency_hz, pairs = (values) => values.map((value, index) => [hz[index], value]).filter(([, value]) => value !== null);
  for (const [id, channel] of Object.entries(CHARTS)) {
    const output = found.outputs.find((one) => one.channel === channel);
    at(id).closest("figure").hidden = !output;
    if (!output) continue;
    const all = [...output.gain_db, ...output.fit_gain_db].filter((one) => one !== null);
    const frame = new Frame(at(id), hz[0], hz[hz.length - 1], Math.min(...all) - 3, Math.max(...all) + 3, "Hz", "x");
    for (const [place, value] of pairs(output.gain_db)) frame.dot(place, value, colour("series-phase"));
    frame.line(pairs(output.fit_gain_db), colour("series-gain"));
  }
  const frame = new Frame(at("fit-coherence"), hz[0], hz[hz.length - 1], 0, 1.05, "Hz", "x");
  found.outputs.forEach((output, index) => frame.line(pairs(output.coherence), colour(["series-gain", "series-phase", "series-third"][index % 3])));
}
