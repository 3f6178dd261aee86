// A controller drafted by hand: its loop, sensitivity and steps follow what is moved.

import { ask, get, post } from "./api.js";
import { at, badge, cell, offer, redrawn, row, said, whenOpened } from "./dom.js";
import { drawNyquist, drawSensitivity, drawStep, figure } from "./loops.js";

const NUMBERS = ["lead-deg", "lead-hz", "pole-rad-s", "notch-hz", "notch-width", "notch-depth"];
const OF_LEAD = ["lead-deg", "lead-hz"], OF_NOTCH = ["notch-hz", "notch-width", "notch-depth"];
const key = (id) => id.replaceAll("-", "_");
let act = null, wanted = null, busy = false, found = null, plans = [];

export function beginDesign(does, planMade) {
  act = does;
  whenOpened(at("design"), () => act(open));
  at("design-model").onchange = change;
  at("design-kind").onchange = (event) => { kind(); change(event); };
  for (const id of NUMBERS) {
    at(id).oninput = (event) => { at(`${id}-slide`).value = at(id).value; change(event); };
    at(`${id}-slide`).oninput = (event) => { at(id).value = at(`${id}-slide`).value; change(event); };
  }
  at("design-save").onsubmit = (event) => { event.preventDefault(); act(save); };
  at("design-download").onclick = () => act(download);
  at("design-plan").onchange = files;
  at("design-use").onsubmit = (event) => { event.preventDefault(); act(() => use(planMade)); };
  redrawn(draw);
}

async function open() {
  await listModels();
  kind();
  change(null);
  await listControllers();
}

export async function listModels() {
  const models = await get("/models");
  offer(at("design-model"), models.map((one) => [one.name, `${one.name}, ${one.kind.replaceAll("_", " ")}${one.warning ? ", doubtful" : ""}`]));
}

async function listControllers() {
  const controllers = await get("/controllers");
  offer(at("design-controller"), controllers.map((one) => [one.name, one.name]));
  plans = [];
  for (const plan of await get("/plans")) {
    const text = await ask("GET", `/plans/${plan.name}/text`, undefined, true);
    const loaded = [...new Set([...text.matchAll(/set_controller:\s*\{?\s*file:\s*["']?([^"'}\s]+)/g)].map((match) => match[1]))];
    if (loaded.length) plans.push({ ...plan, loaded });
  }
  offer(at("design-plan"), plans.map((plan) => [plan.name, plan.title || plan.name]));
  files();
}

function files() {
  const plan = plans.find((one) => one.name === at("design-plan").value);
  offer(at("design-file"), (plan?.loaded ?? []).map((file) => [file, file]));
}

function kind() {
  const lead = at("design-kind").value === "phase";
  for (const id of OF_LEAD) at(id).closest(".slide").hidden = !lead;
  for (const id of OF_NOTCH) at(id).closest(".slide").hidden = lead;
}

function chosen() {
  const body = { model: at("design-model").value, stabilisation: at("design-kind").value };
  for (const id of NUMBERS) if (at(id).value !== "") body[key(id)] = Number(at(id).value);
  return body;
}

// One question is under way at a time; of those that come meanwhile only the newest is asked.
function change(event) {
  if (!at("design-model").value || !at("design-numbers").checkValidity()) return;
  wanted = { body: chosen(), since: event?.timeStamp ?? performance.now() };
  if (!busy) follow();
}

async function follow() {
  busy = true;
  while (wanted) {
    const { body, since } = wanted;
    wanted = null;
    if (!found) at("design-message").textContent = "Reading the model …";
    const answer = await act(() => post("/drafts", body));
    if (!answer || body.model !== at("design-model").value || body.stabilisation !== at("design-kind").value) continue; // stale
    if (!found) at("design-message").textContent = "";
    found = answer;
    show();
    requestAnimationFrame(() => performance.measure("drafted", { start: since, end: performance.now() }));
  }
  busy = false;
}

function show() {
  const { margins, unstable, steps, notes, resonance_hz: resonance } = found;
  at("notch-hz").placeholder = resonance.toFixed(2);
  at("design-stable").replaceChildren(badge(unstable || !margins.stable ? "unstable" : "stable"));
  at("design-unstable").textContent = unstable;
  const peaks = steps.map((one) => row(cell(`peak of T_s at ${one.speed_km_h} km/h`, "", "th"), cell(figure(one.peak_shaft_torque_nm, "N m"), "number"), cell(`overshoot ${figure(one.overshoot_shaft_torque_nm, "N m")}`)));
  const where = (hz) => (hz === null ? "" : `at ${figure(hz, "Hz")}`);
  at("design-figures").tBodies[0].replaceChildren(
    row(cell("gain margin", "", "th"), cell(figure(margins.gain_margin_db, "dB", 1), "number"), cell(where(margins.gain_margin_hz))),
    row(cell("phase margin", "", "th"), cell(figure(margins.phase_margin_deg, "°", 1), "number"), cell(where(margins.phase_margin_hz))),
    row(cell("delay margin", "", "th"), cell(figure(margins.delay_margin_s === null ? null : 1000 * margins.delay_margin_s, "ms", 1), "number"), cell("")),
    row(cell("largest |S|", "", "th"), cell(figure(margins.sensitivity_peak, "", 3), "number"), cell(where(margins.sensitivity_peak_hz))),
    row(cell("largest |S| in 8 to 20 Hz", "", "th"), cell(figure(margins.comfort_peak, "", 3), "number"), cell("")),
    ...peaks,
  );
  at("design-notes").replaceChildren(...[...notes, found.steps_why_not].filter(Boolean).map((note) => said(note, "quiet")));
  draw();
}

function draw() {
  if (!found || !at("nyquist").clientWidth) return;
  const [pi, loop] = found.loops, { margins } = found;
  drawNyquist(at("nyquist"), [{ ...pi, role: "series-reference" }, { ...loop, role: "series-gain" }]);
  drawSensitivity(at("sensitivity"), found.frequency_hz, [{ values: pi.sensitivity, role: "series-reference" }, { values: loop.sensitivity, role: "series-gain" }]);
  at("nyquist").setAttribute("aria-label", `Nyquist curve of the open loop: gain margin ${figure(margins.gain_margin_db, "dB", 1)}, phase margin ${figure(margins.phase_margin_deg, "degrees", 1)}`);
  at("sensitivity").setAttribute("aria-label", `Sensitivity over frequency: at most ${figure(margins.sensitivity_peak, "", 2)}`);
  ["step-slow", "step-fast"].forEach((id, index) => {
    const step = found.steps[index];
    at(id).closest("figure").hidden = !step;
    if (!step) return;
    drawStep(at(id), found.time_s, step.shaft_torque_nm, found.step_nm);
    at(`${id}-peak`).textContent = `peak ${figure(step.peak_shaft_torque_nm, "N m")}`;
    at(id).setAttribute("aria-label", `Shaft torque at ${step.speed_km_h} km/h after a step of ${found.step_nm} N m: peak ${figure(step.peak_shaft_torque_nm, "N m")}`);
  });
}

const designed = async () => {
  at("design-message").textContent = "Designing: every plant that the uncertainty allows …";
  try {
    const design = await post("/designs", { ...chosen(), name: at("design-name").value || undefined });
    const worst = `The worst of ${design.source} has |S| ${figure(design.worst_sensitivity_peak, "", 2)}; ${Math.round(100 * design.stable_share)} % are stable.`;
    at("design-warnings").replaceChildren(said(worst, "quiet"), ...design.warnings.map((one) => said(one, "bad")));
    return design;
  } finally { at("design-message").textContent = ""; }
};

async function save() {
  const name = at("design-name").value;
  const { controller } = await designed();
  await ask("PUT", `/controllers/${name}`, controller);
  await listControllers();
  at("design-controller").value = name;
  at("design-message").textContent = `Saved as ${name}; plans can load it.`;
}

async function download() {
  const { controller } = await designed();
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([controller], { type: "application/toml" })), download: "controller.toml" });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function use(planMade) {
  const plan = at("design-plan").value, controller = at("design-controller").value;
  const made = await post(`/plans/${plan}/copies`, { name: at("design-copy").value || `${plan}-${controller}`.slice(0, 64), controllers: { [at("design-file").value]: controller } });
  at("design-message").textContent = `The plan ${made.name} is saved and selected under 'Start a plan'.`;
  await planMade(made.name);
}
