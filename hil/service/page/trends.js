// How the criteria of a plan went from run to run.

import { get } from "./api.js";
import { TrendChart } from "./chart.js";
import { at } from "./dom.js";
import { number } from "./frame.js";

let found = [], chart = null;

export async function showTrends(bench, plan) {
  const query = new URLSearchParams({ bench, plan });
  const trends = await get(`/trends?${query}`);
  const before = at("criterion").value;
  found = trends.filter((one) => one.points.some((point) => point.value !== null));
  at("trends").hidden = found.length === 0;
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
  const cpk = trend.cpk === null ? "" : `, Cpk ${number(trend.cpk)}`;
  at("trend-figures").textContent = `mean ${number(trend.mean)} ${trend.unit}${limits ? `, limit ${limits}` : ""}${cpk}`;
  at("trend").setAttribute("aria-label", `${trend.criterion} over ${trend.points.length} runs: ${at("trend-figures").textContent}`);
}
