// Lowest and highest values over time: of a stretch that was asked for, or of the last minutes as they come.

import type { RunTraces } from "../api/types.ts";
import type { Samples } from "../live.ts";

type Values = (number | null)[];

export interface Trace {
  lowest: Values;
  highest: Values;
}

// All channels have the same places on the time axis: the middles of buckets.
export interface Traces {
  time: number[];
  channels: Record<string, Trace>;
}

export const NO_TRACES: Traces = { time: [], channels: {} };
const KEPT_S = 180;

export function tracesOf(found: RunTraces): Traces {
  const count = Math.max(0, ...Object.values(found.channels).map(({ lowest }) => lowest.length));
  return { time: middles(found.start_s, found.width_s, count), channels: found.channels };
}

const middles = (start: number, width: number, count: number): number[] => Array.from({ length: count }, (_, at) => start + (at + 0.5) * width);

// What came while somebody watches, the last minutes of it.
export class Recent {
  traces: Traces = NO_TRACES;

  clear(): void {
    this.traces = NO_TRACES;
  }

  get last(): number {
    return this.traces.time.at(-1) ?? 0;
  }

  add(samples: Samples): void {
    const names = Object.keys(samples.channels);
    const had = this.traces.channels;
    if (Object.keys(had).length !== names.length || names.some((name) => !(name in had))) this.clear();
    const { time, channels } = before(this.traces, samples.start_s);
    const count = Math.max(0, ...names.map((name) => samples.channels[name]?.lowest.length ?? 0));
    const all = [...time, ...middles(samples.start_s, samples.width_s, count)];
    const oldest = (all.at(-1) ?? 0) - KEPT_S, gone = all.findIndex((one) => one >= oldest);
    this.traces = {
      time: all.slice(gone),
      channels: Object.fromEntries(names.map((name) => [name, {
        lowest: [...(channels[name]?.lowest ?? []), ...(samples.channels[name]?.lowest ?? [])].slice(gone),
        highest: [...(channels[name]?.highest ?? []), ...(samples.channels[name]?.highest ?? [])].slice(gone),
      }])),
    };
  }
}

// What lies before a moment: a service that is asked again sends once more what came last.
function before(traces: Traces, start: number): Traces {
  const end = traces.time.findLastIndex((one) => one < start) + 1;
  if (end === traces.time.length) return traces;
  const cut = ({ lowest, highest }: Trace): Trace => ({ lowest: lowest.slice(0, end), highest: highest.slice(0, end) });
  return { time: traces.time.slice(0, end), channels: Object.fromEntries(Object.entries(traces.channels).map(([name, trace]) => [name, cut(trace)])) };
}

// At most so many places, each with the lowest and the highest of those that it is made of: a screen shows no more.
// They are counted from the first, so that a curve that is moved keeps its shape.
export function thinned({ time, channels }: Traces, most: number): Traces {
  const by = Math.ceil(time.length / Math.max(1, most));
  if (by <= 1) return { time, channels };
  const count = Math.ceil(time.length / by);
  const merged = (values: Values, extreme: (...values: number[]) => number): Values => Array.from({ length: count }, (_, at) => {
    const there = values.slice(at * by, (at + 1) * by).filter((one): one is number => one !== null);
    return there.length ? extreme(...there) : null;
  });
  return {
    time: Array.from({ length: count }, (_, at) => 0.5 * ((time[at * by] as number) + (time[Math.min(time.length, (at + 1) * by) - 1] as number))),
    channels: Object.fromEntries(Object.entries(channels).map(([name, { lowest, highest }]) => [name, { lowest: merged(lowest, Math.min), highest: merged(highest, Math.max) }])),
  };
}

// Where a time lies among sorted ones: the nearest.
export function nearest(time: readonly number[], at: number): number {
  let low = 0, high = time.length - 1;
  if (high < 0) return -1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((time[middle] as number) <= at) low = middle; else high = middle;
  }
  return Math.abs((time[low] as number) - at) <= Math.abs((time[high] as number) - at) ? low : high;
}

// The value at a time: lowest and highest of its bucket, equal where it has one sample; null where nothing was measured.
export function valueAt(traces: Traces, channel: string, at: number): { lowest: number; highest: number } | null {
  const trace = traces.channels[channel], time = traces.time;
  const place = nearest(time, at);
  if (!trace || place < 0) return null;
  const width = time.length > 1 ? (time[1] as number) - (time[0] as number) : 1;
  const lowest = trace.lowest[place], highest = trace.highest[place];
  if (Math.abs((time[place] as number) - at) > 1.5 * width || lowest == null || highest == null) return null;
  return { lowest, highest };
}

export const middleOf = (value: { lowest: number; highest: number } | null): number | null => (value ? 0.5 * (value.lowest + value.highest) : null);
