// The form that starts a plan: what it will do is predicted first.

import { get, post } from "./api.js";
import { at, offer, said } from "./dom.js";
import { number } from "./frame.js";

const WAIT_MS = 400;
let plans = [], timer = 0, asked = 0;

export async function begin(bench, queued, failed) {
  await list();
  at("plan").onchange = () => { choose(); predictSoon(bench); };
  at("variables").oninput = () => predictSoon(bench);
  at("start").onsubmit = async (event) => {
    event.preventDefault();
    try {
      queued(await post("/runs", { ...wanted(bench()), key: crypto.randomUUID ? crypto.randomUUID() : "" }));
    } catch (error) { failed(error); }
  };
  choose();
  predictSoon(bench);
}

async function list() {
  plans = await get("/plans");
  offer(at("plan"), plans.map((plan) => [plan.name, plan.title || plan.name]));
}

// A plan that has just come is the one that is to be started.
export async function choosePlan(name) {
  await list();
  at("plan").value = name;
  at("plan").dispatchEvent(new Event("change"));
}

export const predictAgain = (bench) => predictSoon(bench);

function choose() {
  const plan = plans.find((one) => one.name === at("plan").value);
  at("plan-about").textContent = plan.description;
  at("variables").replaceChildren(...Object.entries(plan.variables).map(([name, variable]) => {
    const label = document.createElement("label");
    const unit = variable.unit ? ` in ${variable.unit}` : "";
    label.textContent = `${variable.description || name}${unit}`;
    const input = Object.assign(document.createElement("input"), {
      type: "number", name, value: variable.default, step: "any", required: true,
      min: variable.lower ?? "", max: variable.upper ?? "",
    });
    label.append(input);
    return label;
  }));
}

function wanted(bench) {
  const inputs = [...at("variables").querySelectorAll("input")];
  return { plan: at("plan").value, bench, values: Object.fromEntries(inputs.map((one) => [one.name, Number(one.value)])) };
}

function predictSoon(bench) {
  clearTimeout(timer);
  at("queue-run").disabled = true;
  asked += 1;
  const mine = asked;
  at("forecast").replaceChildren(said("Predicting duration and peaks …"));
  timer = setTimeout(() => predict(bench(), mine), WAIT_MS);
}

async function predict(bench, mine) {
  let shown, may = false;
  try {
    if (!at("start").checkValidity()) throw new Error("A variable is beyond its bounds.");
    const found = await post("/forecasts", wanted(bench));
    shown = table(found);
    may = found.fits;
  } catch (error) {
    shown = [said(error.fix ? `${error.message} (${error.fix})` : error.message, "bad")];
    may = error.status === 503; // what cannot be predicted may still be run
  }
  if (mine !== asked) return;
  at("forecast").replaceChildren(...shown);
  at("queue-run").disabled = !may;
}

function table(found) {
  const failing = found.criteria.filter((one) => one.verdict === "fail").length;
  const rows = Object.entries(found.predicted).map(([name, { value, limit }]) => {
    const row = document.createElement("tr");
    const cells = [name, number(value), number(limit), `${Math.round((100 * value) / limit)} %`];
    cells.forEach((text, index) => {
      const cell = document.createElement(index ? "td" : "th");
      if (!index) cell.scope = "row"; else cell.className = value > limit ? "number bad" : "number";
      cell.textContent = text;
      row.append(cell);
    });
    return row;
  });
  const made = document.createElement("table");
  const head = document.createElement("tr");
  ["predicted", "peak", "limit", "used"].forEach((text, index) => {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.className = index ? "number" : "";
    cell.textContent = text;
    head.append(cell);
  });
  made.createTHead().append(head);
  made.createTBody().append(...rows);
  const scroll = document.createElement("div");
  scroll.className = "scroll";
  scroll.append(made);
  const time = `About ${Math.round(found.duration_s)} s of bench time.`;
  const verdict = found.fits ? said(`${time} Fits the bench.`) : said(`${time} It exceeds the limits of the bench and cannot be queued.`, "bad");
  const loads = Object.entries(found.bus_loads).map(([bus, load]) => `${bus} at most ${Math.round(100 * load)} %`);
  const overloaded = Object.values(found.bus_loads).some((load) => load > 1);
  const buses = loads.length ? [said(`Load of the buses: ${loads.join(", ")}.`, overloaded ? "bad" : "")] : [];
  const criteria = failing ? [said(`${failing} of ${found.criteria.length} criteria are predicted to fail.`, "bad")] : [];
  return [verdict, ...buses, ...criteria, scroll];
}
