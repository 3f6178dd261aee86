// A bench as it changes: the service's events (docs/reference/api.md), shared by all parts of a page that watch it.

import { useEffect, useState } from "preact/hooks";
import { API } from "./api/client.ts";
import { noteUnknown, silent } from "./api/reached.ts";
import type { Bench, Run } from "./api/types.ts";
import { Store, useStore } from "./store.ts";

export interface BenchState {
  bench: Bench;
  running: Run | null;
  message: string;
  queue: Run[];
  viewers: string[]; // names of those who have the bench open
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
const AGAIN_MS = 2000;

// Whether the service is heard of: what is shown may be old otherwise.
export const lost = new Store(false);

// Browsers open six connections to a service at most: all parts of a page that watch a bench share one.
class Watched {
  readonly live: Live;
  readonly #takers = new Set<(samples: Samples) => void>();
  readonly #wanted = new Map<symbol, string[]>();
  readonly #bench: string;
  #timer = 0;
  #asked: string | null = null;
  #close: () => void = () => {};

  constructor(bench: string) {
    this.#bench = bench;
    this.live = {
      state: new Store<BenchState | null>(null),
      criteria: new Store<{ run: number; criteria: Criterion[] } | null>(null),
      marks: new Store<{ run: number; marks: Mark[] } | null>(null),
      onSamples: (take) => { this.#takers.add(take); return () => { this.#takers.delete(take); }; },
    };
  }

  want(part: symbol, channels: string[]): void {
    this.#wanted.set(part, channels);
    this.#soon();
  }

  leave(part: symbol): void {
    this.#wanted.delete(part);
    this.#soon();
  }

  // What several parts want at the same moment is asked for once.
  #soon(): void {
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#ask(), TOGETHER_MS);
  }

  #ask(): void {
    if (!this.#wanted.size) {
      this.#close();
      watched.delete(this.#bench);
      return;
    }
    const channels = [...new Set([...this.#wanted.values()].flat())].sort().join(",");
    if (channels === this.#asked) return;
    this.#close();
    this.#asked = channels;
    this.#close = open(this.#bench, channels ? channels.split(",") : [], this.live, (samples) => { for (const take of this.#takers) take(samples); });
  }
}

const TOGETHER_MS = 20;
const watched = new Map<string, Watched>();
const NO_LIVE = new Watched("").live;

export function useLive(bench: string | null, channels: readonly string[] = []): Live {
  const [part] = useState(() => Symbol("part"));
  const key = channels.join(",");
  const found = bench === null ? null : watchedOf(bench);
  useEffect(() => {
    if (!found) return undefined;
    return () => found.leave(part);
  }, [found, part]);
  useEffect(() => found?.want(part, key ? key.split(",") : []), [found, part, key]);
  return found?.live ?? NO_LIVE;
}

function watchedOf(bench: string): Watched {
  const known = watched.get(bench) ?? new Watched(bench);
  watched.set(bench, known);
  return known;
}

// A browser gives up on an answer that is none: who asks is not known any more, or a proxy answers for a service that
// is away. The first is for the session to find out, the second is asked again.
function open(bench: string, channels: string[], live: Live, onSamples: (samples: Samples) => void): () => void {
  let timer = 0, close = () => {};
  const begin = () => {
    close = follow(bench, channels, live, onSamples, () => {
      close();
      lost.value = true;
      noteUnknown();
      timer = window.setTimeout(begin, AGAIN_MS);
    });
  };
  begin();
  return () => { clearTimeout(timer); close(); };
}

function follow(bench: string, channels: string[], live: Live, onSamples: (samples: Samples) => void, onEnd: () => void): () => void {
  const query = new URLSearchParams(channels.map((channel) => ["channel", channel]));
  const events = new EventSource(`${API}/benches/${encodeURIComponent(bench)}/live${channels.length ? `?${query}` : ""}`);
  let heard = Date.now();
  const take = <T>(name: string, work: (data: T) => void) => events.addEventListener(name, (event) => {
    heard = Date.now();
    lost.value = false;
    work(JSON.parse((event as MessageEvent<string>).data) as T);
  });
  take<BenchState>("state", (state) => { live.state.value = state; });
  take<Samples>("samples", onSamples);
  take<{ run: number; criteria: Criterion[] }>("criteria", (found) => { live.criteria.value = found; });
  take<{ run: number; marks: Mark[] }>("marks", (found) => { live.marks.value = found; });
  take("here", () => {}); // nothing is new
  events.addEventListener("signed_out", onEnd);
  events.onopen = () => { heard = Date.now(); lost.value = false; };
  events.onerror = () => {
    lost.value = true;
    if (events.readyState === EventSource.CLOSED) onEnd();
  };
  const timer = setInterval(() => { if (Date.now() - heard > LOST_MS) lost.value = true; }, 1000);
  return () => { events.close(); clearInterval(timer); lost.value = false; };
}

export function useLost(): boolean {
  const events = useStore(lost), asked = useStore(silent);
  return events || asked;
}
