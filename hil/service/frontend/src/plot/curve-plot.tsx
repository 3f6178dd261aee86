// Curves over anything but time: over frequency (then on a logarithmic axis), over seconds from a step, over a value.

import type { JSX } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { figure, significant } from "../format.ts";
import { colour, coloured } from "../theme.ts";
import { drawBand } from "./canvas.ts";
import { axis, HEIGHT, onWidth, roomy } from "./frame.ts";
import { decades } from "./range.ts";

export type Values = readonly (number | null)[];

export interface Curve {
  name: string;
  role: string; // of the page's colours for series
  x: readonly number[];
  y: Values;
  looks?: "line" | "dots" | "dashes" | "bars";
  reach?: { lower: Values; upper: Values }; // an interval around it
}

export interface CurvePlotOptions {
  title: JSX.Element | string;
  label: string; // for those who do not see it
  curves: Curve[];
  x: { unit: string; log?: boolean };
  y: { unit: string; low?: number; high?: number };
  band?: readonly [number, number];
  limits?: readonly number[];
  uprights?: readonly number[]; // limits of what is along x
  says?: string; // beside the title while nothing is pointed at
}

export function CurvePlot(options: CurvePlotOptions): JSX.Element {
  const place = useRef<HTMLDivElement>(null), plot = useRef<uPlot | null>(null), now = useRef(options);
  const [pointed, setPointed] = useState("");
  now.current = options;
  const { title, label, curves, says } = options;
  const shape = JSON.stringify([options.x, options.y, curves.map((one) => [one.name, one.role, one.looks, Boolean(one.reach)])]);
  const data = useMemo(() => dataOf(curves), [curves]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, now, setPointed);
    plot.current = made;
    const stops = [coloured.subscribe(() => made.redraw(false, true)), onWidth(element, (width) => made.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, [shape]);
  useEffect(() => plot.current?.setData(data, true), [data, shape]);
  return (
    <figure class="plot">
      <figcaption><b>{title}</b>{curves.length > 1 ? <Key curves={curves} /> : null}<output class="quiet">{pointed || says || ""}</output></figcaption>
      <div class="canvas" ref={place} role="img" aria-label={label} />
    </figure>
  );
}

function Key({ curves }: { curves: Curve[] }): JSX.Element {
  return <>{curves.map((one) => <span class="chip" key={one.name}><span class={`swatch ${one.role}`} />{one.name}</span>)}</>;
}

const seriesCount = (curve: Curve): number => (curve.reach ? 3 : 1);

function dataOf(curves: Curve[]): uPlot.AlignedData {
  if (!curves.length) return [[], []];
  const tables = curves.map(({ x, y, reach }) => [x, y, ...(reach ? [reach.upper, reach.lower] : [])] as unknown as uPlot.AlignedData);
  return tables.length === 1 ? tables[0] as uPlot.AlignedData : uPlot.join(tables);
}

function seriesOf({ role, looks, reach }: Curve): uPlot.Series[] {
  const stroke = () => colour(`series-${role}`), bars = looks === "bars" ? uPlot.paths.bars?.({ size: [0.96], align: 0 }) : undefined;
  const dotted = looks === "dots";
  const main: uPlot.Series = {
    stroke, width: dotted ? 0 : 1.6, ...(looks === "dashes" ? { dash: [6, 4] } : {}), ...(bars ? { paths: bars, fill: stroke } : {}),
    ...(dotted ? { paths: () => null } : {}), points: { show: dotted, size: 3, fill: stroke, stroke, width: 0 },
  };
  const edge: uPlot.Series = { stroke: "transparent", width: 0, points: { show: false } };
  return reach ? [main, edge, edge] : [main];
}

function make(element: HTMLElement, now: { current: CurvePlotOptions }, point: (text: string) => void): uPlot {
  const { curves, x, y } = now.current;
  const starts = curves.map((_, at) => 1 + curves.slice(0, at).reduce((sum, one) => sum + seriesCount(one), 0));
  const faint = (role: string) => `color-mix(in srgb, ${colour(`series-${role}`)} 25%, transparent)`;
  return new uPlot({
    width: Math.max(200, element.clientWidth), height: HEIGHT, legend: { show: false },
    scales: { x: { time: false, ...(x.log ? { distr: 3 } : {}), range: (_, low, high) => alongOf(now.current, low, high) }, y: { range: (_, low, high) => rangeOf(now.current, low, high) } },
    axes: [axis({ space: 50, size: 28, ...(x.log ? { splits: (_, __, low, high) => decades(low, high) } : {}), values: (_, values) => named(x.log ? roundOnes(values) : values, x.unit) }), axis({ size: 56, unit: y.unit })],
    series: [{}, ...curves.flatMap(seriesOf)],
    bands: curves.flatMap((one, at) => (one.reach ? [{ series: [(starts[at] as number) + 1, (starts[at] as number) + 2] as [number, number], fill: () => faint(one.role) }] : [])),
    cursor: { drag: { x: false, y: false }, points: { show: false } },
    hooks: {
      drawAxes: [(plot) => { const { band } = now.current; if (band) drawBand(plot, ...band); }],
      draw: [(plot) => drawLimitsOf(plot, now.current)],
      setCursor: [(plot) => point(pointedAt(plot, now.current, starts))],
    },
  }, dataOf(curves), element);
}

function rangeOf({ y, limits = [] }: CurvePlotOptions, low: number | null, high: number | null): [number, number] {
  const ends = [low, high, ...limits].filter((one): one is number => one !== null);
  const [from, to] = ends.length ? roomy(Math.min(...ends), Math.max(...ends)) : [0, 1];
  return [y.low ?? from, y.high ?? to];
}

// Bars and limits have their place; lines end where they end.
function alongOf({ curves, uprights = [] }: CurvePlotOptions, low: number | null, high: number | null): [number, number] {
  const bars = curves.find((one) => one.looks === "bars");
  if (!bars) return [low ?? 1, high ?? 2];
  const half = 0.5 * ((bars.x[1] ?? (bars.x[0] ?? 0) + 1) - (bars.x[0] ?? 0));
  return roomy(Math.min((low ?? 0) - half, ...uprights), Math.max((high ?? 1) + half, ...uprights));
}

// Of a logarithmic axis that begins anywhere, round ones alone are named.
const roundOnes = (values: readonly (number | null)[]): (number | null)[] => values.map((one) => (one !== null && /^[125](e|$)/.test((one.toExponential(3).replace(/\.?0+e/, "e"))) ? one : null));

// The last of them says of what they are.
function named(values: readonly (number | null)[], unit: string): string[] {
  const last = values.findLastIndex((one) => one !== null);
  return values.map((one, at) => (one === null ? "" : `${significant(one, 3)}${at === last && unit ? ` ${unit}` : ""}`));
}

function pointedAt(plot: uPlot, { curves, x, y }: CurvePlotOptions, starts: number[]): string {
  const at = plot.cursor.idx;
  if (at === null || at === undefined) return "";
  const place = plot.data[0][at], values = starts.slice(0, curves.length).map((one) => plot.data[one]?.[at]);
  return `${figure(place, x.unit)}: ${values.map((one) => figure(one ?? null)).join(", ")} ${y.unit}`;
}

function drawLimitsOf(plot: uPlot, { limits = [], uprights = [] }: CurvePlotOptions): void {
  const { ctx: pen, bbox: box } = plot, one = devicePixelRatio;
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  pen.strokeStyle = colour("series-limit");
  pen.lineWidth = 1.4 * one;
  pen.setLineDash([6 * one, 4 * one]);
  pen.beginPath();
  for (const y of limits.map((level) => plot.valToPos(level, "y", true))) { pen.moveTo(box.left, y); pen.lineTo(box.left + box.width, y); }
  for (const x of uprights.map((place) => plot.valToPos(place, "x", true))) { pen.moveTo(x, box.top); pen.lineTo(x, box.top + box.height); }
  pen.stroke();
  pen.restore();
}
