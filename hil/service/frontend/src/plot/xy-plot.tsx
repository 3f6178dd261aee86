// One channel over another, in the stretch of time that is shown.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { get } from "../api/client.ts";
import type { RunSamples } from "../api/types.ts";
import { t } from "../i18n/text.ts";
import { colour, coloured } from "../theme.ts";
import { axis, HEIGHT, onWidth, roleOf, roomy } from "./frame.ts";
import type { Range } from "./range.ts";

interface Found {
  x: (number | null)[];
  y: (number | null)[];
}

export function XyPlot({ run, channels, units, range }: { run: number; channels: string[]; units: Record<string, string>; range: Range }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const points = useRef<Found>({ x: [], y: [] });
  const plot = useRef<uPlot | null>(null);
  const [about, setAbout] = useState("");
  const [x = "", y = ""] = channels;
  const query = new URLSearchParams([["channel", x], ["channel", y], ["start_s", range.from.toFixed(3)], ["end_s", range.to.toFixed(3)]]).toString();
  useEffect(() => {
    if (!y) return undefined;
    const control = new AbortController();
    const look = async () => {
      try {
        const found = await get<RunSamples>(`/runs/${run}/samples?${query}`, control.signal);
        points.current = { x: found.channels[x] ?? [], y: found.channels[y] ?? [] };
        setAbout(found.every > 1 ? t("One sample in {count} is drawn.", { count: found.every }) : t("Every sample is drawn."));
      } catch (error) {
        if (control.signal.aborted) return;
        points.current = { x: [], y: [] };
        setAbout((error as Error).message);
      }
      plot.current?.setData([[0, 1], [0, 1]], true);
    };
    const timer = setTimeout(() => void look(), 200);
    return () => { control.abort(); clearTimeout(timer); };
  }, [run, query]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, points, t("{channel} in {unit}", { channel: x, unit: units[x] ?? "" }), units[y] ?? "");
    plot.current = made;
    const stops = [coloured.subscribe(() => made.redraw(false, true)), onWidth(element, (width) => made.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, [x, y, units[x], units[y]]);
  return (
    <>
      <div class="canvas" ref={place} />
      <p class="quiet">{y ? about : t("Add a second channel.")}</p>
    </>
  );
}

// The library wants rising x: it makes the axes, and the line is drawn here.
function make(element: HTMLElement, points: { current: Found }, below: string, unit: string): uPlot {
  const around = (values: (number | null)[]): [number, number] => {
    const there = values.filter((one): one is number => one !== null);
    return there.length ? roomy(Math.min(...there), Math.max(...there)) : [0, 1];
  };
  return new uPlot({
    width: Math.max(200, element.clientWidth),
    height: HEIGHT,
    legend: { show: false },
    scales: { x: { time: false, range: () => around(points.current.x) }, y: { range: () => around(points.current.y) } },
    axes: [axis({ space: 60, size: 28, unit: below }), axis({ size: 56, unit })],
    series: [{}, { show: false }],
    cursor: { drag: { x: false, y: false }, points: { show: false } },
    hooks: { draw: [(plot) => draw(plot, points.current)] },
  }, [[0, 1], [0, 1]], element);
}

function draw(plot: uPlot, { x, y }: Found): void {
  const { ctx: pen, bbox: box } = plot;
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.width, box.height);
  pen.clip();
  pen.strokeStyle = colour(`series-${roleOf(0)}`);
  pen.lineWidth = devicePixelRatio;
  pen.beginPath();
  let down = false;
  x.forEach((value, at) => {
    const other = y[at];
    if (value === null || other === null || other === undefined) { down = false; return; }
    const left = plot.valToPos(value, "x", true), top = plot.valToPos(other, "y", true);
    if (down) pen.lineTo(left, top); else pen.moveTo(left, top);
    down = true;
  });
  pen.stroke();
  pen.restore();
}
