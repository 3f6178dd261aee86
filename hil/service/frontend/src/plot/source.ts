// Traces for the stretch that is shown: as they come while it follows, else asked for, as many as the screen has places.

import { useEffect, useMemo, useState } from "preact/hooks";
import { get } from "../api/client.ts";
import type { RunTraces } from "../api/types.ts";
import type { Live } from "../live.ts";
import { Store } from "../store.ts";
import { isFollowing, rangeOf, type Range, type Shown } from "./range.ts";
import { NO_TRACES, Recent, tracesOf, type Traces } from "./traces.ts";

export interface Source {
  traces: Store<Traces>;
  range: Store<Range>;
  newest: Store<Traces>; // of the live run, whatever is shown
  last: number;
}

const SOON_MS = 60;
const AGAIN_MS = 1000;
const NUMBERS_MS = 200; // no one reads faster
const MOST = 1200;

export interface Wanted {
  run: number;
  live: Live | null; // null: the run is over
  channels: string[];
  shown: Shown;
  first: number;
  last: number; // as the view of the run had it
}

export function useSource({ run, live, channels, shown, first, last }: Wanted): Source {
  const [stores] = useState(() => ({ traces: new Store<Traces>(NO_TRACES), range: new Store<Range>({ from: 0, to: 1 }), newest: new Store<Traces>(NO_TRACES) }));
  const recent = useMemo(() => new Recent(), [run]);
  const [measured, setMeasured] = useState(last);
  const key = channels.join(",");
  const follows = live !== null && isFollowing(shown);
  const end = live ? Math.max(last, measured) : last;
  useEffect(() => {
    if (!live) return undefined;
    let frame = 0, numbersMs = 0, later = 0;
    const showNumbers = () => {
      later = 0;
      numbersMs = performance.now();
      stores.newest.value = recent.traces;
    };
    const show = () => {
      frame = 0;
      // The last of them is shown as well: a run that waits sends nothing for minutes.
      later ||= window.setTimeout(showNumbers, Math.max(0, NUMBERS_MS - (performance.now() - numbersMs)));
      if (!follows) return;
      stores.range.value = rangeOf(shown, first, Math.max(last, recent.last));
      stores.traces.value = recent.traces;
    };
    const stop = live.onSamples((samples) => {
      if (samples.run !== run) return;
      recent.add(samples);
      frame ||= requestAnimationFrame(show); // as often as the screen is drawn, and no more
    });
    const timer = setInterval(() => setMeasured(recent.last), AGAIN_MS);
    show();
    return () => { stop(); clearInterval(timer); clearTimeout(later); cancelAnimationFrame(frame); };
  }, [live, run, follows, follows ? (shown as { follow: number }).follow : 0, first]);
  const range = rangeOf(shown, first, end);
  const grows = live !== null && !follows && range.to >= end - 2 ? end : 0; // what is held may still be filling
  useEffect(() => {
    if (follows) return undefined;
    stores.range.value = range;
    if (!key) { stores.traces.value = NO_TRACES; return undefined; }
    const control = new AbortController();
    const wide = range.to - range.from; // a little beyond both ends, so that a small move shows no gap
    const query = new URLSearchParams([...key.split(",").map((channel) => ["channel", channel]), ["start_s", (range.from - 0.1 * wide).toFixed(4)], ["end_s", (range.to + 0.1 * wide).toFixed(4)], ["most", String(MOST)]] as string[][]);
    const timer = setTimeout(() => {
      get<RunTraces>(`/runs/${run}/traces?${query}`, control.signal).then((found) => { stores.traces.value = tracesOf(found); }).catch(() => {});
    }, SOON_MS);
    return () => { control.abort(); clearTimeout(timer); };
  }, [run, key, follows, range.from, range.to, grows]);
  return { ...stores, last: end };
}
