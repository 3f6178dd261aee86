// Two runs side by side: criteria with differences, what they were given differently, traces overlaid.

import { get } from "./api.js";
import { at, badge, cell, offer, redrawn, row, said, whenOpened } from "./dom.js";
import { Frame, colour, number } from "./frame.js";

const CHARTS = ["compare-shaft", "compare-speed", "compare-other"];
const CHANNELS = { "compare-shaft": "shaft_torque_nm", "compare-speed": "motor_speed_rad_s" };
const NEAR_S = [-0.1, 2];
const LEAST_BUCKETS = 200;
let runs = [], found = null, drawn = {}, asked = 0;

export function beginComparison(bench, act) {
  whenOpened(at("compare"), () => act(() => list(bench())));
  at("compare-first").onchange = () => { others(); act(compare); };
  at("compare-second").onchange = () => act(compare);
  for (const id of ["compare-segment", "compare-stretch", "compare-channel"]) at(id).onchange = () => act(overlay);
  redrawn(draw);
}

// Called whenever a run has ended.
export async function list(bench) {
  if (!at("compare").open) return;
  const all = await get(`/runs?bench=${encodeURIComponent(bench)}&most=200&state=ended&state=interrupted`);
  runs = all.filter((run) => run.files.includes("recording.mcap"));
  offer(at("compare-first"), runs.map((run) => [run.id, named(run)]));
  others();
  if (!found) await compare();
}

function others() {
  const first = runs.find((run) => String(run.id) === at("compare-first").value);
  const same = runs.filter((run) => first && run.plan === first.plan && run.id !== first.id);
  offer(at("compare-second"), same.map((run) => [run.id, named(run)]));
  at("compare-none").hidden = same.length > 0;
  at("compare-second").disabled = same.length === 0;
}

const named = (run) => `run ${run.id}: ${run.title || run.plan}, ${run.verdict ?? run.state}, ${new Date(run.ended_at).toLocaleString()}`;

async function compare() {
  const first = at("compare-first").value, other = at("compare-second").value;
  found = null;
  at("compare-found").hidden = true;
  if (!first || !other) return;
  at("compare-lead").textContent = "Reading both recordings …";
  asked += 1;
  const mine = asked;
  try {
    const answer = await get(`/comparisons?first=${first}&other=${other}`);
    if (mine !== asked) return;
    found = answer;
  } finally {
    if (mine === asked && !found) at("compare-lead").textContent = "";
  }
  show();
  await overlay();
}

function show() {
  const { first, other, distance, differences, notes } = found;
  const far = distance === null ? "No criterion has a value in both runs." : `Mean difference of the criteria of run ${other.id} from run ${first.id}: ${(100 * distance).toPrecision(2)} %.`;
  at("compare-lead").textContent = far;
  at("compare-notes").replaceChildren(...notes.map((note) => said(note, "quiet")));
  at("compare-same").hidden = differences.length > 0;
  at("compare-differences").hidden = differences.length === 0;
  at("compare-differences").tBodies[0].replaceChildren(...differences.map((one) => row(cell(one.kind, "", "th"), cell(one.name), cell(one.first, "number wraps"), cell(one.other, "number wraps"))));
  at("compare-criteria").tBodies[0].replaceChildren(...found.criteria.map(criterion));
  for (const one of document.querySelectorAll(".name-first")) one.textContent = `run ${first.id}`;
  for (const one of document.querySelectorAll(".name-other")) one.textContent = `run ${other.id}`;
  offer(at("compare-segment"), found.segments.map((one) => [one.id, one.id]));
  at("compare-found").hidden = false;
}

function criterion(one) {
  const relative = one.relative === null ? "–" : `${one.relative > 0 ? "+" : ""}${(100 * one.relative).toFixed(1)} %`.replace("-", "−");
  const values = one.values.map((value, index) => {
    const shown = document.createElement("span");
    shown.append(value === null ? "– " : `${number(value)} ${one.unit} `, badge(one.verdicts[index]));
    return cell(shown, "number");
  });
  return row(cell(one.title || one.id, "", "th"), ...values, cell(relative, "number"), cell(one.limit || "–", "number"));
}

async function overlay() {
  const segment = found?.segments.find((one) => one.id === at("compare-segment").value);
  if (!segment) return;
  offer(at("compare-channel"), segment.channels.filter((name) => !Object.values(CHANNELS).includes(name)).map((name) => [name, name]));
  const wanted = new URLSearchParams({ first: found.first.id, other: found.other.id, segment: segment.id });
  if (at("compare-stretch").value === "near") { wanted.set("start_s", NEAR_S[0]); wanted.set("end_s", NEAR_S[1]); }
  asked += 1;
  const mine = asked;
  const answers = await Promise.all(CHARTS.map((id) => {
    wanted.set("channel", CHANNELS[id] ?? at("compare-channel").value);
    wanted.set("most", Math.max(LEAST_BUCKETS, at(id).clientWidth));
    return segment.channels.includes(wanted.get("channel")) ? get(`/comparisons/traces?${wanted}`) : null;
  }));
  if (mine !== asked) return;
  drawn = Object.fromEntries(CHARTS.map((id, index) => [id, answers[index]]));
  draw();
}

function draw() {
  for (const id of CHARTS) if (drawn[id] && at(id).clientWidth) drawTraces(at(id), drawn[id]);
}

function drawTraces(canvas, { channel, unit, start_s: start, width_s: width, runs: both }) {
  const buckets = both.map(({ lowest, highest }) => lowest.map((low, at) => [start + (at + 0.5) * width, low, highest[at]]).filter((one) => one[1] !== null));
  const all = buckets.flat(), low = Math.min(...all.map((one) => one[1])), high = Math.max(...all.map((one) => one[2]));
  const room = Math.max(high - low, 1e-3 * Math.max(Math.abs(high), Math.abs(low)), 1e-9);
  const frame = new Frame(canvas, start, start + width * both[0].lowest.length, low - 0.05 * room, high + 0.05 * room, "s");
  ["series-gain", "series-phase"].forEach((role, index) => frame.envelope(buckets[index], colour(role), index ? 1.2 : 3)); // the one below shows at its edges
  const peaks = buckets.map((some) => number(Math.max(...some.map((one) => Math.abs(one[2])))));
  canvas.setAttribute("aria-label", `${channel} of run ${found.first.id} and run ${found.other.id} from the step; largest ${peaks.join(" and ")} ${unit}`);
  at(`${canvas.id}-peaks`).textContent = `largest ${peaks.join(" and ")} ${unit}`;
}
