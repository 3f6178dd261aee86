// Channels over time: the lowest and the highest value of each bucket, so that no peak is lost.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import type { Mark } from "../api/types.ts";
import type { Store } from "../store.ts";
import { colour, coloured } from "../theme.ts";
import { drawCursors, drawLimits, drawMarks } from "./canvas.ts";
import { axis, HEIGHT, inSight, onWidth, reaching, roleOf, roomy } from "./frame.ts";
import { failedIn, marksOf, type ChannelLimit } from "./limit-lines.ts";
import { panned, zoomed, type Range } from "./range.ts";
import { thinned, type Traces } from "./traces.ts";

export interface TimePlotOptions {
  channels: string[];
  units: Record<string, string>;
  traces: Store<Traces>;
  range: Store<Range>;
  marks: Mark[];
  limits: ChannelLimit[];
  cursors: number[];
  chosen: number;
  onRange: (range: Range) => void;
  onCursor: (cursor: number, at: number) => void;
  onHover: (at: number | null) => void;
}

const NEAR_PX = 7;

export function TimePlot(options: TimePlotOptions): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const now = useRef(options);
  now.current = options;
  const { traces, range } = options;
  const shape = options.channels.map((channel) => `${channel} ${options.units[channel] ?? ""}`).join(",");
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, now);
    plot.current = made;
    const drawing = inSight(element, () => {
      const data = dataOf(now.current, made);
      if (made.data === data) made.setScale("x", { min: range.value.from, max: range.value.to });
      else made.setData(data, true);
    });
    const stops = [
      drawing.stop,
      traces.subscribe(drawing.ask),
      range.subscribe(drawing.ask),
      coloured.subscribe(() => made.redraw(false, true)),
      onWidth(element, (width) => { made.setSize({ width, height: HEIGHT }); drawing.ask(); }),
      listenToWheel(made, now),
    ];
    drawing.ask();
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, [shape, traces, range]);
  const { marks, limits, cursors, chosen } = options;
  useEffect(() => plot.current?.redraw(false, false), [marks, limits, cursors, chosen]);
  return <div class="canvas" ref={place} />;
}

type Now = { current: TimePlotOptions };

function make(element: HTMLElement, now: Now): uPlot {
  const { channels, units } = now.current;
  const scales = [...new Set(channels.map((channel) => units[channel] ?? ""))];
  const options: uPlot.Options = {
    width: Math.max(200, element.clientWidth),
    height: HEIGHT,
    legend: { show: false },
    scales: {
      x: { time: false, range: () => [now.current.range.value.from, now.current.range.value.to] },
      ...Object.fromEntries(scales.map((unit) => [unit || "none", { range: (_: uPlot, low: number | null, high: number | null) => rangeOf(now.current, unit, low, high) }])),
    },
    axes: [axis({ space: 70, size: 28 }), ...scales.slice(0, 2).map((unit, at) => axis({ scale: unit || "none", unit, size: 56, side: at ? 1 : 3, grid: { show: at === 0, stroke: () => colour("grid"), width: 1 } }))],
    series: [{}, ...channels.flatMap((channel, at) => [seriesOf(units[channel] ?? "", at), seriesOf(units[channel] ?? "", at)])],
    bands: channels.map((_, at) => ({ series: [2 * at + 1, 2 * at + 2], fill: () => colour(`series-${roleOf(at)}`) })),
    cursor: { sync: { key: "time" }, drag: { x: true, y: false, setScale: false }, points: { show: false }, bind: { mousedown: grabbed(now) } },
    hooks: {
      setSelect: [(plot) => select(plot, now)],
      setCursor: [(plot) => now.current.onHover(plot.cursor.left !== undefined && plot.cursor.left >= 0 ? plot.posToVal(plot.cursor.left, "x") : null)],
      drawAxes: [(plot) => drawMarks(plot, now.current.marks, now.current.range.value.to)],
      draw: [(plot) => decorate(plot, now.current)],
    },
  };
  return new uPlot(options, [[], ...channels.flatMap(() => [[], []])], element);
}

const seriesOf = (unit: string, at: number): uPlot.Series => ({ scale: unit || "none", stroke: () => colour(`series-${roleOf(at)}`), width: 1.3, points: { size: 4 } });

const onScale = ({ channels, units }: TimePlotOptions, unit: string): string[] => channels.filter((channel) => (units[channel] ?? "") === unit);

function rangeOf(options: TimePlotOptions, unit: string, low: number | null, high: number | null): [number, number] {
  const failed = low === null || high === null ? [] : failedIn(options.limits, onScale(options, unit), options.range.value, low, high);
  return roomy(...reaching(low, high, failed));
}

const PLACES = 1.3; // for each pixel of what is shown, as more than that was asked for

// The same again while neither traces nor width have changed: then only the range moves.
function dataOf({ channels, traces, range }: TimePlotOptions, plot: uPlot): uPlot.AlignedData {
  const { from, to } = range.value, most = PLACES * plot.bbox.width;
  const known = drawn.get(plot);
  if (known && known.of === traces.value && known.channels === channels.join() && known.most === most) return known.data;
  const time = traces.value.time, width = ((time.at(-1) ?? 0) - (time[0] ?? 0)) / Math.max(1e-9, to - from);
  const data = aligned(channels, most > 0 ? thinned(traces.value, most * Math.max(1, width)) : traces.value);
  drawn.set(plot, { of: traces.value, channels: channels.join(), most, data });
  return data;
}

const drawn = new WeakMap<uPlot, { of: Traces; channels: string; most: number; data: uPlot.AlignedData }>();

function aligned(channels: string[], traces: Traces): uPlot.AlignedData {
  const empty = traces.time.map(() => null);
  return [traces.time, ...channels.flatMap((channel) => [traces.channels[channel]?.highest ?? empty, traces.channels[channel]?.lowest ?? empty])];
}

function decorate(plot: uPlot, options: TimePlotOptions): void {
  for (const unit of new Set(options.channels.map((channel) => options.units[channel] ?? ""))) drawLimits(plot, unit || "none", marksOf(options.limits, onScale(options, unit), unit));
  drawCursors(plot, options.cursors, options.chosen);
}

// What was dragged over is shown; a click puts the chosen cursor there.
function select(plot: uPlot, now: Now): void {
  const { left, width } = plot.select;
  if (width < 3) return;
  const from = plot.posToVal(left, "x"), to = plot.posToVal(left + width, "x");
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  now.current.onRange({ from, to });
}

// A press near a cursor drags it, with shift it drags the time axis; any other begins a selection.
function grabbed(now: Now): NonNullable<NonNullable<uPlot.Cursor["bind"]>["mousedown"]> {
  return (plot, _target, otherwise) => (event: MouseEvent) => {
    const at = event.clientX - plot.over.getBoundingClientRect().left;
    const cursor = now.current.cursors.findIndex((one) => Math.abs(plot.valToPos(one, "x") - at) < NEAR_PX);
    if (cursor >= 0) drag((move) => now.current.onCursor(cursor, plot.posToVal(move.clientX - plot.over.getBoundingClientRect().left, "x")));
    else if (event.shiftKey) {
      const begun = now.current.range.value, width = plot.over.clientWidth;
      drag((move) => now.current.onRange(panned(begun, (event.clientX - move.clientX) / width)));
    } else otherwise(event);
    return null;
  };
}

// A mouse says where it is more often than the screen is drawn.
function drag(move: (event: MouseEvent) => void): void {
  let frame = 0, latest: MouseEvent | null = null;
  const show = () => { frame = 0; if (latest) move(latest); };
  const take = (event: MouseEvent) => { latest = event; frame ||= requestAnimationFrame(show); };
  const end = () => { removeEventListener("mousemove", take); removeEventListener("mouseup", end); };
  addEventListener("mousemove", take);
  addEventListener("mouseup", end);
}

// With Ctrl the wheel zooms, with Shift or sideways it moves the time; otherwise it scrolls the page.
function listenToWheel(plot: uPlot, now: Now): () => void {
  const turned = (event: WheelEvent) => {
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (!event.ctrlKey && !event.metaKey && !sideways) return;
    event.preventDefault();
    const range = now.current.range.value;
    if (event.ctrlKey || event.metaKey) {
      const around = plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x");
      now.current.onRange(zoomed(range, Math.exp(event.deltaY / 300), around));
    } else now.current.onRange(panned(range, sideways / plot.over.clientWidth));
  };
  plot.over.addEventListener("wheel", turned, { passive: false });
  return () => plot.over.removeEventListener("wheel", turned);
}
