// The page: one bench at a time, its state, its run, its queue and its results. The service says what is new.

import { ask, findStopPost, get, post, stopNow } from "./api.js";
import { beginCampaigns } from "./campaigns.js";
import { SpectrumChart, TimeChart } from "./chart.js";
import { beginComparison, list as listCompared } from "./compare.js";
import { beginDesign } from "./design.js";
import { beginDiagnosis } from "./diagnose.js";
import { at, badge, cell, row } from "./dom.js";
import { number } from "./frame.js";
import { beginIdentification } from "./identify.js";
import { begin, choosePlan, predictAgain } from "./start.js";
import { drawTrend, showTrends } from "./trends.js";

const STATES = { free: "Free", running: "Running", ending: "Ending a lost run", in_use: "In use", emergency_stop: "Emergency stop", away: "Agent not connected" };
const ROLES = ["viewer", "operator", "engineer", "admin"];
const KINDS = { "report.html": "report", "report.pdf": "PDF", "recording.mcap": "recording", "result.json": "result", "log.txt": "log" };
const LOST_MS = 15000, BENCHES_MS = 5000;

const charts = {
  speed: new TimeChart(at("speed"), [{ channel: "motor_speed_rad_s", role: "gain" }]),
  shaft: new TimeChart(at("shaft"), [{ channel: "shaft_torque_nm", role: "phase" }]),
  torque: new TimeChart(at("torque"), [{ channel: "motor_torque_ref_nm", role: "reference" }, { channel: "motor_torque_nm", role: "third" }]),
  spectrum: new SpectrumChart(at("spectrum")),
};
let bench = "", events = null, shownRun = -1, running = null, me = null, dirty = true, over = "", heard = 0;

function failed(error) {
  at("problem").textContent = error.fix ? `${error.message}\n${error.fix}` : error.message;
  at("problem").hidden = false;
}

async function act(work) {
  at("problem").hidden = true;
  try { return await work(); } catch (error) { failed(error); return null; }
}

const may = (role) => ROLES.indexOf(me.role) >= ROLES.indexOf(role);

async function open() {
  try {
    me = await get("/me");
  } catch (error) {
    if (error.status !== 401) { failed(error); setTimeout(open, 2000); return; }
    at("login").hidden = false;
    at("secret").focus();
    return;
  }
  at("login").hidden = true;
  at("content").hidden = false;
  at("me").textContent = me.tokens ? `${me.name}, ${me.role}` : "";
  if (!await showBenches(decodeURIComponent(location.hash.slice(1)))) {
    at("state").textContent = "No bench yet";
    at("why").textContent = "Agents bring them: hil bench agent --server URL";
    setTimeout(open, 2000);
    return;
  }
  bench = at("bench").value;  // what is open already asks for its runs
  setInterval(() => showBenches(bench).catch(() => {}), BENCHES_MS);
  beginComparison(() => bench, act);
  beginIdentification(() => bench, act, may("engineer"));
  beginDiagnosis(() => bench, act, may("engineer"));
  beginCampaigns(act, may("engineer"));
  at("design").hidden = !may("engineer");
  if (may("engineer")) beginDesign(act, choosePlan);
  watch();
  if (may("operator")) await act(() => begin(() => bench, () => {}, failed));
  else at("start").closest("section").hidden = true;
}

// Agents may bring more at any time.
async function showBenches(chosen) {
  findStopPost().catch(() => {});
  const names = (await get("/benches")).map((one) => one.name), shown = [...at("bench").options].map((one) => one.value);
  if (names.join() !== shown.join()) at("bench").replaceChildren(...names.map((name) => new Option(name, name)));
  if (names.length) at("bench").value = names.includes(chosen) ? chosen : names[0];
  return names.length;
}

function watch() {
  bench = at("bench").value;
  location.hash = encodeURIComponent(bench);
  events?.close();
  shownRun = -1;
  over = "";
  clear();
  events = new EventSource(`/api/v1/benches/${encodeURIComponent(bench)}/live`);
  const take = (name, work) => events.addEventListener(name, (event) => { here(); work(JSON.parse(event.data)); });
  take("state", showState);
  take("samples", (data) => { of(data.run); Object.values(charts).forEach((chart) => chart.add?.(data)); showNow(); });
  take("spectrum", (data) => { of(data.run); charts.spectrum.found = data; at("now-band").textContent = `${number(data.band_energy)} (rad/s)²`; dirty = true; });
  take("criteria", (data) => { of(data.run); showCriteria(data.criteria); });
  take("here", () => {});  // nothing is new
  events.onopen = here;
  events.onerror = () => { at("lost").hidden = false; };
}

function here() {
  heard = Date.now();
  at("lost").hidden = true;
}

function of(run) {
  if (run !== shownRun) { clear(); shownRun = run; at("live-run").textContent = `run ${run}`; }
}

function clear() {
  Object.values(charts).forEach((chart) => chart.clear());
  ["now-speed", "now-shaft", "now-torque", "now-band", "live-run"].forEach((id) => { at(id).textContent = ""; });
  showCriteria([]);
  dirty = true;
}

function showState({ bench: now, running: run, queue, message }) {
  running = run;
  at("banner").className = `banner ${now.state}`;
  at("bench-title").textContent = `${now.title || now.name}${now.simulated ? " (simulated)" : ""}${now.machine ? `, at ${now.machine}` : ""}${now.lease ? `, for ${now.lease} alone` : ""}`;
  at("state").textContent = run ? `Running: ${run.title || run.plan}` : STATES[now.state];
  if (["emergency_stop", "away"].includes(now.state)) at("state").textContent = STATES[now.state];
  if (!now.stop_confirmed) at("state").textContent = "Emergency stop asked for, NOT CONFIRMED";
  at("why").textContent = run && now.state === "running" ? `run ${run.id}, by ${run.requested_by}: ${run.doing}` : now.why;
  at("share").hidden = !run;
  at("share").value = run?.share ?? 0;
  at("message").hidden = !message;
  at("message").textContent = message;
  at("answer").hidden = !message || !may("operator") || now.away_since !== null;
  const held = run?.doing.startsWith("held") ?? false;
  for (const id of ["pause", "resume", "end"]) at(id).hidden = !run || !may("operator") || (id === "pause" ? held : id === "resume" && !held) || (id !== "end" && now.away_since !== null);
  at("reset").hidden = now.state !== "emergency_stop" || run !== null || !may("engineer");
  at("let-go").hidden = now.away_since === null || !may("engineer");
  charts.torque.limit = now.limits.motor_torque_nm ?? null;
  charts.shaft.limit = now.limits.shaft_torque_nm ?? null;
  charts.speed.limit = now.limits.motor_speed_rad_s ?? null;
  showQueue(queue);
  const seen = `${now.running} ${now.state} ${queue.map((one) => one.id)}`;
  if (seen !== over) { over = seen; showResults(); }
}

function showNow() {
  const unit = { speed: "rad/s", shaft: "N m", torque: "N m" };
  for (const id of ["speed", "shaft", "torque"]) {
    const chart = charts[id], value = chart.newest(id === "torque" ? 1 : 0);
    at(`now-${id}`).textContent = value === null ? "" : `${number(value)} ${unit[id]}${chart.limit ? `, limit ±${number(chart.limit)}` : ""}`;
  }
  dirty = true;
}

function button(text, label, work) {
  const made = Object.assign(document.createElement("button"), { type: "button", textContent: text });
  made.setAttribute("aria-label", label);
  made.onclick = () => act(work);
  return made;
}

function showCriteria(criteria) {
  at("no-criteria").hidden = criteria.length > 0;
  at("criteria").hidden = criteria.length === 0;
  at("criteria").tBodies[0].replaceChildren(...criteria.map((one) => {
    const limit = one.upper !== null ? `≤ ${number(one.upper)}` : one.lower !== null ? `≥ ${number(one.lower)}` : "–";
    return row(cell(one.title || one.id, "", "th"), cell(one.value === null ? "–" : `${number(one.value)} ${one.unit}`, "number"), cell(limit, "number"), cell(badge(one.verdict)));
  }));
}

function showQueue(queue) {
  at("no-queue").hidden = queue.length > 0;
  at("queue").replaceChildren(...queue.map((run) => {
    const made = document.createElement("li"), text = document.createElement("span"), actions = document.createElement("span");
    text.textContent = `${run.id}: ${run.title || run.plan}, by ${run.requested_by}`;
    if (run.state === "waiting_approval") {
      text.append(Object.assign(document.createElement("span"), { className: "reason", textContent: `waits for approval: ${run.hazard}` }));
      if (may("engineer") && run.requested_by !== me.name) actions.append(button("Approve", `Approve run ${run.id}`, () => post(`/runs/${run.id}/approve`)));
    }
    if (may("operator")) actions.append(button("Cancel", `Cancel run ${run.id}`, () => post(`/runs/${run.id}/abort`)));
    made.append(text, actions);
    return made;
  }));
}

async function showResults() {
  const query = ["ended", "interrupted", "cancelled"].map((state) => `state=${state}`).join("&");
  const runs = await act(() => get(`/runs?bench=${encodeURIComponent(bench)}&most=30&${query}`)) ?? [];
  const newest = runs.find((run) => run.state === "ended");
  if (newest) await act(() => showTrends(bench, newest.plan)); else at("trends").hidden = true;
  await act(() => listCompared(bench));
  at("no-results").hidden = runs.length > 0;
  at("results").hidden = runs.length === 0;
  at("results").tBodies[0].replaceChildren(...runs.map((run) => {
    const plan = cell(run.title || run.plan, "", "th"), values = Object.entries(run.values).map(([name, value]) => `${name} = ${value}`).join(", ");
    const said = [values, run.reason.split("\n")[0]].filter(Boolean).join("; ");
    if (said) plan.append(Object.assign(document.createElement("span"), { className: "reason", textContent: said }));
    const files = document.createElement("span");
    files.className = "files";
    for (const [name, text] of Object.entries(KINDS)) {
      if (!run.files.includes(name)) continue;
      const link = Object.assign(document.createElement("a"), { href: `/api/v1/runs/${run.id}/files/${name}`, textContent: text });
      link.setAttribute("aria-label", `${text} of run ${run.id}`);
      files.append(link);
    }
    const safe = run.safe_state === "not_confirmed" ? cell("NOT CONFIRMED SAFE", "bad") : cell(run.safe_state === "confirmed" ? "safe" : "–");
    const verdict = run.state === "cancelled" ? "cancelled" : run.state === "interrupted" ? "interrupted" : run.verdict ?? "error";
    const again = may("operator") ? button("Again", `Queue run ${run.id} again`, () => post("/runs", { plan: run.plan, bench: run.bench, values: run.values })) : "";
    return row(cell(String(run.id), "number"), plan, cell(badge(verdict)), safe, cell(run.ended_at ? new Date(run.ended_at).toLocaleString() : ""), cell(run.requested_by), cell(files), cell(again));
  }));
}

at("stop").onclick = () => act(async () => {
  await stopNow(bench ? `/benches/${encodeURIComponent(bench)}/emergency-stop` : "/emergency-stop");
});
at("bench").onchange = () => { watch(); predictAgain(() => bench); };
at("criterion").onchange = drawTrend;
at("pause").onclick = () => act(() => post(`/runs/${running.id}/pause`));
at("resume").onclick = () => act(() => post(`/runs/${running.id}/resume`));
at("end").onclick = () => act(() => post(`/runs/${running.id}/abort`));
at("reset").onclick = () => act(() => post(`/benches/${encodeURIComponent(bench)}/reset`));
at("let-go").onclick = () => {
  if (confirm(`Is ${bench} no longer driven by its agent? It can then be driven by another agent. A run of this agent is marked as interrupted.`))
    act(() => ask("DELETE", `/benches/${encodeURIComponent(bench)}/agent`));
};
at("answer").onsubmit = (event) => {
  event.preventDefault();
  act(() => post(`/runs/${running.id}/answer`, { text: at("answer-text").value }));
  at("answer-text").value = "";
};
at("login").onsubmit = async (event) => {
  event.preventDefault();
  if (await act(async () => { await ask("POST", "/session", { secret: at("secret").value }); return true; })) open();
};
window.onresize = () => { dirty = true; };
matchMedia("(prefers-color-scheme: dark)").onchange = () => { dirty = true; };
setInterval(() => { if (events && Date.now() - heard > LOST_MS) at("lost").hidden = false; }, 1000);
(function frame() {
  if (dirty) { dirty = false; drawTrend(); Object.values(charts).forEach((chart) => chart.draw()); }
  requestAnimationFrame(frame);
})();
open();
