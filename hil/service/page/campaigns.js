// Campaigns: many simulations of a plan, how many are done, and which share of them passes so far.

import { ask, get, post } from "./api.js";
import { at, badge, cell, offer, row, said, whenOpened } from "./dom.js";

const LOOK_MS = 1500;
const OVER = ["ended", "failed", "cancelled"];
const FILES = { "report.html": "report", "report.pdf": "PDF", "simulations.parquet": "table", "campaign.json": "figures" };
let examples = [], timer = 0;

export function beginCampaigns(act, may) {
  at("campaign-wanted").hidden = !may;
  whenOpened(at("campaigns"), () => act(async () => { if (may) await offerExamples(); await look(); }));
  at("campaigns").addEventListener("toggle", () => { if (at("campaigns").open) act(look); });
  at("campaign-example").onchange = showExample;
  at("campaign-file").onchange = () => act(async () => { at("campaign-text").value = await at("campaign-file").files[0].text(); });
  at("campaign-wanted").onsubmit = (event) => { event.preventDefault(); act(begin); };

  async function begin() {
    const beside = await Promise.all([...at("campaign-beside").files].map(async (file) => [file.name, await file.text()]));
    const campaign = await post("/campaigns", { text: at("campaign-text").value, files: Object.fromEntries(beside) });
    at("campaign-message").textContent = `Campaign ${campaign.id} is queued: ${campaign.simulations} simulations.`;
    await look();
  }

  async function look() {
    clearTimeout(timer);
    const all = await get("/campaigns");
    at("no-campaigns").hidden = all.length > 0;
    at("campaign-list").hidden = all.length === 0;
    const focused = document.activeElement?.id;
    at("campaign-list").tBodies[0].replaceChildren(...all.map(shown));
    if (/^campaign-(do|remove)-/.test(focused)) at(focused)?.focus();
    if (at("campaigns").open && all.some((one) => !OVER.includes(one.state))) timer = setTimeout(() => act(look), LOOK_MS);
  }

  function shown(campaign) {
    const name = cell(campaign.title || campaign.name, "", "th");
    const about = [`${campaign.plan} on ${campaign.model}, by ${campaign.requested_by}`, campaign.place, campaign.reason.split("\n")[0]].filter(Boolean).join("; ");
    name.append(Object.assign(document.createElement("span"), { className: "reason", textContent: about }));
    const state = campaign.passed === null ? campaign.state : campaign.passed ? "pass" : "fail";
    return row(cell(String(campaign.id), "number"), name, cell(badge(state)), cell(progress(campaign)), cell(shares(campaign)), cell(links(campaign)), cell(may && !campaign.place ? actions(campaign) : ""));
  }

  function actions({ id, state }) {
    const made = document.createElement("span"), over = OVER.includes(state);
    const [text, what] = over ? ["Resume", "resume"] : [state === "stopping" ? "End now" : "Cancel", "cancel"];
    if (state !== "ended") made.append(button(id, "do", text, () => post(`/campaigns/${id}/${what}`)));
    if (over) made.append(button(id, "remove", "Remove", () => confirm(`Remove campaign ${id} with its files?`) && ask("DELETE", `/campaigns/${id}`)));
    return made;
  }

  function button(id, what, text, work) {
    const made = Object.assign(document.createElement("button"), { type: "button", textContent: text, id: `campaign-${what}-${id}` });
    made.setAttribute("aria-label", `${text}: campaign ${id}`);
    made.onclick = () => act(async () => { await work(); await look(); });
    return made;
  }
}

async function offerExamples() {
  examples = await get("/campaign-examples");
  offer(at("campaign-example"), [...examples.map((one) => [one.name, one.title || one.name]), ["own file", "own file"]]);
  showExample();
}

function showExample() {
  const chosen = examples.find((one) => one.name === at("campaign-example").value);
  at("campaign-own").hidden = Boolean(chosen);
  if (chosen) at("campaign-text").value = chosen.text;
}

function progress({ id, state, done, simulations, rate_hz: rate }) {
  const made = document.createElement("div"), bar = document.createElement("progress");
  Object.assign(bar, { max: simulations, value: done });
  bar.setAttribute("aria-label", `Progress of campaign ${id}`);
  const left = rate > 0 ? (simulations - done) / rate : 0;
  const still = state === "running" && left ? `, ${rate.toFixed(1)} a second, ${left < 90 ? `${Math.ceil(left)} s` : `${Math.ceil(left / 60)} min`} left` : "";
  made.append(...(OVER.includes(state) && done === simulations ? [] : [bar]), said(`${done} of ${simulations}${still}`, "quiet"));
  return made;
}

const percent = (share) => `${(100 * share).toFixed(1)}\u00a0%`;

// The band is the interval, the line in it the share that passed.
function shares({ controllers }) {
  const made = document.createElement("div");
  made.append(...controllers.map(({ controller, passed, of, share, interval }) => {
    const one = document.createElement("div"), band = document.createElement("span");
    const text = `${controller ? `${controller.replaceAll("_", " ")}: ` : ""}${percent(share)} (${passed} of ${of}${interval ? `; ${percent(interval[0])} to ${percent(interval[1])}` : ""})`;
    const [low, high] = interval ?? [share, share];
    band.className = "share";
    for (const [name, value] of [["low", low], ["wide", high - low], ["share", share]]) band.style.setProperty(`--${name}`, `${100 * value}%`);
    one.append(text, band);
    return one;
  }));
  return made;
}

function links({ id, files }) {
  const made = document.createElement("span");
  made.className = "files";
  for (const [name, text] of Object.entries(FILES)) {
    if (!files.includes(name)) continue;
    const link = Object.assign(document.createElement("a"), { href: `/api/v1/campaigns/${id}/files/${name}`, textContent: text });
    link.setAttribute("aria-label", `${text} of campaign ${id}`);
    made.append(link);
  }
  return made;
}
