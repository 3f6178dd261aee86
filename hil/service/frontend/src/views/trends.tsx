// How a criterion of a plan went from run to run, with its limits, its scatter and Cpk.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import type { Trend } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { figure, limitText } from "../format.ts";
import { axis, HEIGHT, onWidth, roomy } from "../plot/frame.ts";
import { go } from "../router.ts";
import { colour, coloured } from "../theme.ts";
import { Section } from "../ui/parts.tsx";

const LEAST = 5; // values of which a scatter is reported

export function Trends({ bench, plan }: { bench: string; plan: string }): JSX.Element | null {
  const [dut, setDut] = useState(""), [criterion, setCriterion] = useState("");
  const query = new URLSearchParams({ bench, plan, ...(dut ? { dut } : {}) });
  const all = useData<Trend[]>(`/trends?${query}`).data ?? [];
  const found = all.filter((one) => one.points.some((point) => point.value !== null));
  const [duts, setDuts] = useState<string[]>([]);
  useEffect(() => {
    if (!dut) setDuts([...new Set(all.flatMap((one) => one.points.map((point) => point.dut)))].filter(Boolean).sort());
  }, [all, dut]);
  const trend = found.find((one) => one.criterion === criterion) ?? found[0];
  if (!trend) return null;
  return (
    <Section title={`Trend over runs of ${plan}`} label="trend">
      <div class="row small">
        <label>Criterion <select value={trend.criterion} onChange={(event) => setCriterion(event.currentTarget.value)}>{found.map((one) => <option key={one.criterion}>{one.criterion}</option>)}</select></label>
        <label>of <select value={dut} onChange={(event) => setDut(event.currentTarget.value)}><option value="">all devices</option>{duts.map((one) => <option key={one}>{one}</option>)}</select></label>
      </div>
      <p class="quiet">{figuresOf(trend)}</p>
      <TrendPlot trend={trend} label={`${trend.criterion} over ${trend.points.length} runs: ${figuresOf(trend)}`} />
    </Section>
  );
}

function figuresOf(trend: Trend): string {
  const limits = limitText(trend.upper, trend.lower, trend.unit), count = trend.count ?? 0;
  const hasCpk = trend.cpk !== null && trend.cpk !== undefined;
  const cpk = hasCpk ? `, Cpk ${figure(trend.cpk)} (95 %: ${figure(trend.cpk_lower)} to ${figure(trend.cpk_upper)}, ${count} runs)` : limits !== "–" && count < LEAST ? `, Cpk: too few runs (${count} of ${LEAST})` : "";
  return `mean ${figure(trend.mean, trend.unit)}${limits === "–" ? "" : `, limit ${limits}`}${cpk}`;
}

function TrendPlot({ trend, label }: { trend: Trend; label: string }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const points = useMemo(() => trend.points.filter((point) => point.value !== null), [trend]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const limits = [trend.lower, trend.upper].filter((one): one is number => one !== null && one !== undefined);
    const values = [...points.map((point) => point.value as number), ...limits];
    const plot = new uPlot({
      width: Math.max(200, element.clientWidth), height: HEIGHT, legend: { show: false },
      scales: { x: { time: false, range: (_, low, high) => [(low ?? 0) - 1, (high ?? 1) + 1] }, y: { range: () => roomy(Math.min(...values), Math.max(...values)) } },
      axes: [axis({ space: 60, size: 28, unit: "run" }), axis({ size: 56, unit: trend.unit })],
      series: [{}, { stroke: () => colour("series-reference"), width: 1.2, points: { size: 7, fill: () => colour("series-gain"), stroke: () => colour("series-gain") } }],
      cursor: { drag: { x: false, y: false } },
      hooks: { draw: [(made) => decorate(made, limits, points)], ready: [(made) => made.over.addEventListener("click", () => open(made, points))] },
    }, [points.map((point) => point.run), points.map((point) => point.value)], element);
    const stops = [coloured.subscribe(() => plot.redraw(false, true)), onWidth(element, (width) => plot.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); plot.destroy(); };
  }, [points, trend]);
  return <div class="canvas" ref={place} role="img" aria-label={label} />;
}

const open = (plot: uPlot, points: Trend["points"]): void => {
  const point = points[plot.cursor.idx ?? -1];
  if (point) go(to.run(point.run));
};

// Limits as lines, and points that failed as squares.
function decorate(plot: uPlot, limits: number[], points: Trend["points"]): void {
  const { ctx: pen, bbox: box } = plot, one = devicePixelRatio;
  pen.save();
  pen.strokeStyle = colour("series-limit");
  pen.lineWidth = 1.4 * one;
  pen.setLineDash([6 * one, 4 * one]);
  for (const limit of limits) {
    const y = plot.valToPos(limit, "y", true);
    pen.beginPath();
    pen.moveTo(box.left, y);
    pen.lineTo(box.left + box.width, y);
    pen.stroke();
  }
  pen.fillStyle = colour("fail");
  for (const point of points) {
    if (point.verdict === "fail") pen.fillRect(plot.valToPos(point.run, "x", true) - 5 * one, plot.valToPos(point.value as number, "y", true) - 5 * one, 10 * one, 10 * one);
  }
  pen.restore();
}
