// The power spectral density of a channel over the stretch that is shown, with the band of 8 to 20 Hz.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { get } from "../api/client.ts";
import type { RunSpectrum } from "../api/types.ts";
import { figure } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { colour, coloured } from "../theme.ts";
import { drawBand } from "./canvas.ts";
import { axis, HEIGHT, onWidth, roleOf, roomy } from "./frame.ts";
import type { Range } from "./range.ts";

const BAND_HZ = [8, 20] as const;
const HIGHEST_HZ = 40;
const SHOWN_FROM_HZ = 4; // slow motion would hide the band

export function SpectrumPlot({ run, channel, unit, range }: { run: number; channel: string; unit: string; range: Range }): JSX.Element {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const [found, setFound] = useState<RunSpectrum | null>(null);
  const [why, setWhy] = useState("");
  const query = new URLSearchParams({ channel, start_s: range.from.toFixed(3), end_s: range.to.toFixed(3) }).toString();
  useEffect(() => {
    const control = new AbortController();
    const look = async () => {
      try {
        setFound(await get<RunSpectrum>(`/runs/${run}/spectrum?${query}`, control.signal));
        setWhy("");
      } catch (error) {
        if (!control.signal.aborted) { setFound(null); setWhy((error as Error).message); }
      }
    };
    const timer = setTimeout(() => void look(), 200);
    return () => { control.abort(); clearTimeout(timer); };
  }, [run, query]);
  useEffect(() => {
    const element = place.current as HTMLDivElement;
    const made = make(element, unit);
    plot.current = made;
    const stops = [coloured.subscribe(() => made.redraw(false, true)), onWidth(element, (width) => made.setSize({ width, height: HEIGHT }))];
    return () => { stops.forEach((stop) => stop()); made.destroy(); plot.current = null; };
  }, [unit]);
  useEffect(() => { plot.current?.setData(dataOf(found), true); }, [found, unit]);
  return (
    <>
      <div class="canvas" ref={place} />
      <p class="quiet">{why ? <English>{why}</English> : (found ? t("8 to 20 Hz: {energy} from {start} to {end}", { energy: figure(found.band_energy, `(${unit})²`), start: figure(found.start_s), end: figure(found.end_s, "s") }) : "…")}</p>
    </>
  );
}

function dataOf(found: RunSpectrum | null): uPlot.AlignedData {
  if (!found) return [[], []];
  const density = found.density.slice(0, Math.ceil(HIGHEST_HZ / found.step_hz) + 1);
  return [density.map((_, at) => at * found.step_hz), density];
}

function make(element: HTMLElement, unit: string): uPlot {
  const highest = (plot: uPlot): [number, number] => {
    const [hz = [], density = []] = plot.data as (number | null)[][];
    const seen = density.filter((one, at) => one !== null && (hz[at] ?? 0) >= SHOWN_FROM_HZ) as number[];
    return [0, roomy(0, seen.length ? Math.max(...seen) : 1)[1]];
  };
  return new uPlot({
    width: Math.max(200, element.clientWidth),
    height: HEIGHT,
    legend: { show: false },
    scales: { x: { time: false, range: () => [0, HIGHEST_HZ] }, y: { range: highest } },
    axes: [axis({ space: 60, size: 28, values: (_, values) => values.map((one) => (one === HIGHEST_HZ ? `${one} Hz` : String(one))) }), axis({ size: 64, unit: unit ? `(${unit})²/Hz` : "" })],
    series: [{}, { stroke: () => colour(`series-${roleOf(0)}`), width: 1.4, points: { show: false } }],
    cursor: { drag: { x: false, y: false }, points: { show: false } },
    hooks: { drawAxes: [(plot) => drawBand(plot, ...BAND_HZ)] },
  }, [[], []], element);
}
