// A bench as it changes: the service's events (docs/reference/api.md), shared by all parts of a view that watch it.

import { useEffect, useState } from "preact/hooks";
import { API } from "./api/client.ts";
import type { Bench, Run } from "./api/types.ts";
import { Store, useStore } from "./store.ts";

export interface BenchState {
  bench: Bench;
  running: Run | null;
  message: string;
  queue: Run[];
}

// Lowest and highest values in buckets of `width_s` from `start_s`.
export interface Samples {
  run: number;
  start_s: number;
  width_s: number;
  channels: Record<string, { lowest: (number | null)[]; highest: (number | null)[] }>;
}

export interface Criterion {
  id: string;
  title: string;
  value: number | null;
  unit: string;
  upper: number | null;
  lower: number | null;
  verdict: string;
  margin: number | null;
  reason: string;
  below: string;
  source: string;
}

export interface Mark {
  kind: "segment" | "event";
  name: string;
  text: string;
  start_s: number;
  end_s: number | null;
}

export interface Live {
  state: Store<BenchState | null>;
  criteria: Store<{ run: number; criteria: Criterion[] } | null>;
  marks: Store<{ run: number; marks: Mark[] } | null>;
  onSamples: (take: (samples: Samples) => void) => () => void;
}

const LOST_MS = 15_000;

// Whether the service is heard of: what is shown may be old otherwise.
export const lost = new Store(false);

export function useLive(bench: string | null, channels: readonly string[] = []): Live {
  const [live] = useState(newLive);
  const key = channels.join(",");
  useEffect(() => {
    if (bench === null) return undefined;
    live.state.value = null;
    return watch(bench, key ? key.split(",") : [], live);
  }, [bench, key, live]);
  return live;
}

type Inside = Live & { takers: Set<(samples: Samples) => void> };

function newLive(): Inside {
  const takers = new Set<(samples: Samples) => void>();
  return {
    state: new Store<BenchState | null>(null),
    criteria: new Store<{ run: number; criteria: Criterion[] } | null>(null),
    marks: new Store<{ run: number; marks: Mark[] } | null>(null),
    takers,
    onSamples: (take) => { takers.add(take); return () => { takers.delete(take); }; },
  };
}

function watch(bench: string, channels: string[], live: Inside): () => void {
  const query = new URLSearchParams(channels.map((channel) => ["channel", channel]));
  const events = new EventSource(`${API}/benches/${encodeURIComponent(bench)}/live${channels.length ? `?${query}` : ""}`);
  let heard = Date.now();
  const take = <T>(name: string, work: (data: T) => void) => events.addEventListener(name, (event) => {
    heard = Date.now();
    lost.value = false;
    work(JSON.parse((event as MessageEvent<string>).data) as T);
  });
  take<BenchState>("state", (state) => { live.state.value = state; });
  take<Samples>("samples", (samples) => { for (const taker of live.takers) taker(samples); });
  take<{ run: number; criteria: Criterion[] }>("criteria", (found) => { live.criteria.value = found; });
  take<{ run: number; marks: Mark[] }>("marks", (found) => { live.marks.value = found; });
  take("here", () => {}); // nothing is new
  events.onopen = () => { heard = Date.now(); lost.value = false; };
  events.onerror = () => { lost.value = true; };
  const timer = setInterval(() => { if (Date.now() - heard > LOST_MS) lost.value = true; }, 1000);
  return () => { events.close(); clearInterval(timer); lost.value = false; };
}

export const useLost = (): boolean => useStore(lost);
