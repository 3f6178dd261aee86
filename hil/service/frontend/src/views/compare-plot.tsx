// A channel of several runs, laid over each other on the time from each run's step.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { get } from "../api/client.ts";
import type { RecordingCurves, RunTraces, RunView } from "../api/types.ts";
import { figure, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import { drawLimits } from "../plot/canvas.ts";
import { axis, HEIGHT, onWidth, reaching, roleOf, roomy } from "../plot/frame.ts";
import { tracesOf } from "../plot/traces.ts";
import { colour, coloured } from "../theme.ts";
import type { Level } from "./compare-levels.ts";

export interface Stretch {
  run: number;
  recording?: number; // a given one in place of a run
  step: number; // on the recording's clock
  from: number; // from the step
  to: number;
}

interface Laid {
  time: number[];
  lowest: (number | null)[];
  highest: (number | null)[];
}

// Where a segment lies in a recording; null where it has none.
export function stretchOf(view: RunView, segment: string, near: boolean): Stretch | null {
  const mark = view.marks.find((one) => one.kind === "segment" && one.name === segment);
  if (!mark || mark.end_s == null) return null;
  const step = mark.step_s ?? mark.start_s;
  return near ? { run: view.run, step, from: -0.1, to: 2 } : { run: view.run, step, from: mark.start_s - step, to: mark.end_s - step };
}

export function ComparePlot({ channel, unit, stretches, levels }: { channel: string; unit: string; stretches: Stretch[]; levels: Level[] }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const [laid, setLaid] = useState<Laid[]>([]);
  const key = JSON.stringify(stretches), drawn = JSON.stringify(levels);
  useEffect(() => {
    const control = new AbortController();
    Promise.all(stretches.map((one) => laidOf(one, channel, control.signal))).then(setLaid).catch(() => {});
    return () => control.abort();
  }, [key, channel]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, stretches.length, unit, levels);
    plot.current = made;
    const stops = [coloured.subscribe(() => made.redraw(false, true)), onWidth(element, (width) => made.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, [stretches.length, unit, drawn]);
  useEffect(() => {
    if (laid.length && laid.length === stretches.length) plot.current?.setData(uPlot.join(laid.map((one) => [one.time, one.highest, one.lowest] as uPlot.AlignedData)), true);
  }, [laid, unit, drawn]);
  const limits = levels.length ? t("limit {limit}", { limit: levels.map(({ value }) => figure(value, unit)).join(", ") }) : "";
  const peaks = laid.map((one) => figure(peakOf(one))).join(", ");
  return (
    <figure class="plot">
      <figcaption><b>{wordsOf(channel)}</b><span class="quiet">{peaks ? [t("largest {peaks} {unit}", { peaks, unit }), limits].filter(Boolean).join(", ") : "…"}</span></figcaption>
      <div class="canvas" ref={place} role="img" aria-label={t("{channel} of runs {runs} from the step; largest {peaks} {unit}", { channel: wordsOf(channel), runs: stretches.map((one) => (one.recording === undefined ? one.run : t("recording {number}", { number: one.recording }))).join(", "), peaks, unit }) + (limits && `, ${limits}`)} />
    </figure>
  );
}

const peakOf = ({ lowest, highest }: Laid): number => Math.max(...[...lowest, ...highest].map((one) => (one === null ? 0 : Math.abs(one))));

async function laidOf({ run, recording, step, from, to }: Stretch, channel: string, signal: AbortSignal): Promise<Laid> {
  if (recording !== undefined) return ofRecording(recording, step, from, to, channel, signal);
  const query = new URLSearchParams({ channel, start_s: (step + from).toFixed(4), end_s: (step + to).toFixed(4), most: "1000" });
  const { time, channels } = tracesOf(await get<RunTraces>(`/runs/${run}/traces?${query}`, signal));
  const { lowest, highest } = channels[channel] ?? { lowest: [], highest: [] };
  return { time: time.map((one) => one - step), lowest, highest };
}

// In the middle of its buckets; empty where the recording has no such channel, or nothing there.
async function ofRecording(recording: number, step: number, from: number, to: number, channel: string, signal: AbortSignal): Promise<Laid> {
  const query = new URLSearchParams({ channel, start_s: (step + from).toFixed(4), end_s: (step + to).toFixed(4), most: "1000" });
  try {
    const { start_s: start, width_s: width, curves: [found] } = await get<RecordingCurves>(`/recordings/${recording}/curves?${query}`, signal);
    return found ? { time: found.lowest.map((_, bucket) => start + (bucket + 0.5) * width - step), lowest: found.lowest, highest: found.highest } : EMPTY;
  } catch (error) {
    if (signal.aborted) throw error;
    return EMPTY;
  }
}

const EMPTY: Laid = { time: [], lowest: [], highest: [] };

// The first run is drawn wider, so that one that lies exactly over it shows at its edges.
function make(element: HTMLElement, count: number, unit: string, levels: Level[]): uPlot {
  const failed = levels.filter((one) => one.failed).map(({ value }) => value);
  const series = (at: number): uPlot.Series => ({ stroke: () => colour(`series-${roleOf(at)}`), width: at ? 1.2 : 3, points: { show: false }, spanGaps: true });
  return new uPlot({
    width: Math.max(200, element.clientWidth), height: HEIGHT, legend: { show: false },
    scales: { x: { time: false }, y: { range: (_, low, high) => roomy(...reaching(low, high, failed)) } },
    axes: [axis({ space: 60, size: 28 }), axis({ size: 56, unit })],
    series: [{}, ...Array.from({ length: count }, (_, at) => [series(at), series(at)]).flat()],
    bands: Array.from({ length: count }, (_, at) => ({ series: [2 * at + 1, 2 * at + 2] as [number, number], fill: () => colour(`series-${roleOf(at)}`) })),
    hooks: { draw: [(plot) => drawLimits(plot, "y", levels.map(({ value }) => ({ value, label: "", failed: false, holds: null })))] },
    cursor: { sync: { key: "compare" }, drag: { x: true, y: false }, points: { show: false } },
  }, [[], ...Array.from({ length: 2 * count }, () => [])] as unknown as uPlot.AlignedData, element);
}
