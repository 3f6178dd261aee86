// How the criteria of a plan went from run to run.

import { get } from "./api.js";
import { TrendChart } from "./chart.js";
import { at, offer } from "./dom.js";
import { number } from "./frame.js";

const LEAST = 5; // values of which a scatter is reported
let found = [], chart = null, duts = new Set(), of = "";

export async function showTrends(bench, plan) {
  const query = new URLSearchParams({ bench, plan });
  if (of !== `${bench} ${plan}`) { of = `${bench} ${plan}`; duts = new Set(); at("trend-dut").value = ""; }
  if (at("trend-dut").value) query.set("dut", at("trend-dut").value);
  const trends = await get(`/trends?${query}`);
  const before = at("criterion").value;
  trends.forEach((trend) => trend.points.forEach((point) => { if (point.dut) duts.add(point.dut); }));
  offer(at("trend-dut"), [["", "all"], ...[...duts].sort().map((dut) => [dut, dut])]);
  at("trend-dut").onchange = () => showTrends(bench, plan);
  found = trends.filter((one) => one.points.some((point) => point.value !== null));
  at("trends").hidden = found.length === 0 && !at("trend-dut").value;
  at("criterion").replaceChildren(...found.map((one) => new Option(one.criterion, one.criterion)));
  if (found.some((one) => one.criterion === before)) at("criterion").value = before;
  at("trends-plan").textContent = plan;
  drawTrend();
}

export function drawTrend() {
  const trend = found.find((one) => one.criterion === at("criterion").value);
  if (!trend) return;
  chart ??= new TrendChart(at("trend"));
  chart.draw(trend);
  const limits = [trend.lower === null ? "" : `≥ ${number(trend.lower)}`, trend.upper === null ? "" : `≤ ${number(trend.upper)}`].filter(Boolean).join(", ");
  const interval = trend.cpk === null ? "" : `, Cpk ${number(trend.cpk)} (95 %: ${number(trend.cpk_lower)} to ${number(trend.cpk_upper)}, ${trend.count} runs)`;
  const cpk = limits && trend.count < LEAST ? `, Cpk: too few runs (${trend.count} of ${LEAST})` : interval;
  at("trend-figures").textContent = `mean ${number(trend.mean)} ${trend.unit}${limits ? `, limit ${limits}` : ""}${cpk}`;
  at("trend").setAttribute("aria-label", `${trend.criterion} over ${trend.points.length} runs: ${at("trend-figures").textContent}`);
}
