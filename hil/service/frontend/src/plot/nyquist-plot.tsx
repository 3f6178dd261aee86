// Nyquist curves of open loops, with the circle that |S| ≤ 2 forbids around −1; circles are round.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { t } from "../i18n/text.ts";
import { colour, coloured } from "../theme.ts";
import { axis, onWidth } from "./frame.ts";
import type { Values } from "./curve-plot.tsx";

const HEIGHT = 300;
const LEFT = -2.6, RIGHT = 1;
export const LARGEST_SENSITIVITY = 2; // |1 + L| = 1/|S|

export interface Loop {
  name: string;
  role: string;
  real: Values;
  imaginary: Values;
}

// The same loop on other cars: faint, and the worst of them dashed.
export interface Cloud {
  role: string;
  cars: { real: Values; imaginary: Values }[];
  worst: number;
}

interface Shown {
  loops: Loop[];
  cloud: Cloud | null;
}

export function NyquistPlot({ loops, cloud = null, label }: { loops: Loop[]; cloud?: Cloud | null; label: string }): JSX.Element {
  const place = useRef<HTMLDivElement>(null), plot = useRef<uPlot | null>(null), now = useRef<Shown>({ loops, cloud });
  now.current = { loops, cloud };
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, now);
    plot.current = made;
    const stops = [coloured.subscribe(() => made.redraw(false, true)), onWidth(element, (width) => made.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, []);
  useEffect(() => plot.current?.redraw(false, false), [loops, cloud]);
  return (
    <figure class="plot">
      <figcaption><b>{t("Nyquist curve")}</b>{loops.map((one) => <span class="chip" key={one.name}><span class={`swatch ${one.role}`} />{one.name}</span>)}{cloud ? <span class="chip"><span class="swatch measured" />{t("worst car")}</span> : null}</figcaption>
      <div class="canvas" ref={place} role="img" aria-label={label} />
    </figure>
  );
}

// The library makes the axes; curves that turn back are drawn here.
function make(element: HTMLElement, now: { current: Shown }): uPlot {
  const half = (plot: uPlot): number => (0.5 * (RIGHT - LEFT) * plot.bbox.height) / Math.max(1, plot.bbox.width);
  return new uPlot({
    width: Math.max(200, element.clientWidth), height: HEIGHT, legend: { show: false },
    scales: { x: { time: false, range: () => [LEFT, RIGHT] }, y: { range: (plot) => (plot.bbox?.width ? [-1.4 * half(plot), 0.6 * half(plot)] : [-2, 1]) } },
    axes: [axis({ space: 50, size: 40, unit: "Re L" }), axis({ size: 56, unit: "Im L" })],
    series: [{}, { show: false }],
    cursor: { show: false },
    hooks: { setSize: [(plot) => plot.setData([[0, 1], [0, 1]], true)], draw: [(plot) => draw(plot, now.current)] },
  }, [[0, 1], [0, 1]], element);
}

function draw(plot: uPlot, { loops, cloud }: Shown): void {
  const { ctx: pen, bbox: box } = plot, one = devicePixelRatio;
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  pen.lineWidth = 1.4 * one;
  circle(plot, 0, 1, "grid", []);
  circle(plot, -1, 1 / LARGEST_SENSITIVITY, "series-limit", [6 * one, 4 * one]);
  if (cloud) drawCloud(plot, cloud);
  pen.lineWidth = 1.8 * one;
  for (const { real, imaginary, role } of loops) curve(plot, real, imaginary, `series-${role}`);
  pen.fillStyle = colour("series-limit");
  pen.fillRect(plot.valToPos(-1, "x", true) - 4 * one, plot.valToPos(0, "y", true) - 4 * one, 8 * one, 8 * one);
  pen.restore();
}

function drawCloud(plot: uPlot, { role, cars, worst }: Cloud): void {
  const pen = plot.ctx, one = devicePixelRatio, marked = cars[worst];
  pen.lineWidth = one;
  pen.globalAlpha = Math.max(0.12, 0.5 / Math.sqrt(cars.length));
  for (const { real, imaginary } of cars) curve(plot, real, imaginary, `series-${role}`);
  pen.globalAlpha = 1;
  if (!marked) return;
  pen.lineWidth = 1.8 * one;
  pen.setLineDash([5 * one, 3 * one]);
  curve(plot, marked.real, marked.imaginary, "series-measured");
  pen.setLineDash([]);
}

function circle(plot: uPlot, around: number, radius: number, role: string, dash: number[]): void {
  const pen = plot.ctx, x = plot.valToPos(around, "x", true);
  pen.setLineDash(dash);
  pen.strokeStyle = colour(role);
  pen.beginPath();
  pen.ellipse(x, plot.valToPos(0, "y", true), Math.abs(plot.valToPos(around + radius, "x", true) - x), Math.abs(plot.valToPos(radius, "y", true) - plot.valToPos(0, "y", true)), 0, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
}

function curve(plot: uPlot, real: Values, imaginary: Values, role: string): void {
  const pen = plot.ctx;
  pen.strokeStyle = colour(role);
  pen.beginPath();
  let down = false;
  real.forEach((re, at) => {
    const im = imaginary[at];
    if (re === null || im === null || im === undefined) { down = false; return; }
    const x = plot.valToPos(re, "x", true), y = plot.valToPos(im, "y", true);
    if (down) pen.lineTo(x, y); else pen.moveTo(x, y);
    down = true;
  });
  pen.stroke();
}
