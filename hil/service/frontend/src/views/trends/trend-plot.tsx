// A trend over the numbers of runs: limits, mean, three deviations around it, values that belong to a signal.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef } from "preact/hooks";
import uPlot from "uplot";
import type { Trend } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { axis, HEIGHT, onWidth, roomy } from "../../plot/frame.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { colour, coloured } from "../../theme.ts";

const WHOLE = [1, 2, 5].flatMap((one) => [0, 1, 2, 3, 4, 5].map((power) => one * 10 ** power)).sort((one, other) => one - other);

export function TrendPlot({ trend, label }: { trend: Trend; label: string }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const points = useMemo(() => trend.points.filter((point) => point.value !== null), [trend]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const values = [...points.map((point) => point.value as number), ...levelsOf(trend).map(({ value }) => value)];
    const runs = points.length ? points.map((point) => point.run) : [0]; // numbers of runs begin with 1, and have no fractions
    const plot = new uPlot({
      width: Math.max(200, element.clientWidth), height: HEIGHT, legend: { show: false },
      scales: { x: { time: false, range: () => [Math.max(0, Math.min(...runs) - 1), Math.max(1, ...runs) + 1] }, y: { range: () => roomy(Math.min(...values), Math.max(...values)) } },
      axes: [axis({ space: 60, size: 28, unit: t("run"), incrs: WHOLE }), axis({ size: 56, unit: trend.unit })],
      series: [{}, { stroke: () => colour("series-reference"), width: 1.2, points: { size: 7, fill: () => colour("series-gain"), stroke: () => colour("series-gain") } }],
      cursor: { drag: { x: false, y: false } },
      hooks: { draw: [(made) => decorate(made, trend, points)], ready: [(made) => made.over.addEventListener("click", () => open(made, points))] },
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

const DASHES: Record<string, number[]> = { limit: [6, 4], mean: [], deviations: [2, 4] };

// Limits as lines, points that failed as squares, those of a signal with a ring.
function decorate(plot: uPlot, trend: Trend, points: Trend["points"]): void {
  const { ctx: pen, bbox: box } = plot, one = devicePixelRatio;
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  for (const { value, kind, role } of levelsOf(trend)) {
    const y = plot.valToPos(value, "y", true);
    pen.strokeStyle = colour(role);
    pen.lineWidth = 1.4 * one;
    pen.setLineDash((DASHES[kind] ?? []).map((length) => length * one));
    pen.beginPath();
    pen.moveTo(box.left, y);
    pen.lineTo(box.left + box.width, y);
    pen.stroke();
  }
  const signalled = new Set((trend.signals ?? []).flatMap((signal) => signal.runs));
  pen.setLineDash([]);
  for (const point of points) {
    const x = plot.valToPos(point.run, "x", true), y = plot.valToPos(point.value as number, "y", true);
    pen.fillStyle = colour("fail");
    if (point.verdict === "fail") pen.fillRect(x - 5 * one, y - 5 * one, 10 * one, 10 * one);
    if (!signalled.has(point.run)) continue;
    pen.strokeStyle = colour("series-phase");
    pen.lineWidth = 2 * one;
    pen.beginPath();
    pen.arc(x, y, 8 * one, 0, 2 * Math.PI);
    pen.stroke();
  }
  pen.restore();
}

function levelsOf({ upper, lower, mean, deviation }: Trend): { value: number; kind: string; role: string }[] {
  const found: { value: number | null | undefined; kind: string; role: string }[] = [
    { value: upper, kind: "limit", role: "series-limit" }, { value: lower, kind: "limit", role: "series-limit" }, { value: mean, kind: "mean", role: "grid" },
  ];
  if (mean != null && deviation) for (const sign of [-1, 1]) found.push({ value: mean + 3 * sign * deviation, kind: "deviations", role: "quiet" });
  return found.flatMap(({ value, ...how }) => (value == null ? [] : [{ value, ...how }]));
}
