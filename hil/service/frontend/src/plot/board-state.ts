// What a board of plots shows: kept in the address, so that it can be sent, and by the service per person and plan.

import { useCallback, useEffect, useMemo, useRef, useState } from "preact/hooks";
import { ask, get } from "../api/client.ts";
import type { Layout } from "../api/types.ts";
import { setQuery, useQuery } from "../router.ts";
import { layoutOf, layoutText, usualLayout, type PlotSpec } from "./layout.ts";
import { numbersFrom, numbersText, rangeFrom, rangeText, type Shown } from "./range.ts";

export interface BoardState {
  plots: PlotSpec[];
  shown: Shown;
  cursors: number[];
  chosen: number;
  setPlots: (plots: PlotSpec[]) => void;
  setShown: (shown: Shown) => void;
  setCursors: (cursors: number[], chosen?: number) => void;
  reset: () => void;
}

export const FOLLOW_S = 30;
const REST_MS = 150; // browsers take an address that changes in every frame for a mistake, and stop taking it

export function useBoardState(plan: string, channels: readonly string[], failed: readonly string[], live: boolean): BoardState {
  const [query] = useQuery();
  const [kept, keep] = useKept(plan);
  const [chosen, setChosen] = useState(0);
  const text = query.get("plots") ?? kept;
  const known = channels.join(",");
  const plots = useMemo(() => (text ? layoutOf(text).map((plot) => ({ ...plot, channels: plot.channels.filter((one) => channels.includes(one)) })) : usualLayout(channels, failed)), [text, known, failed.join()]);
  const time = query.get("t"), marks = query.get("c");
  const [moving, setMoving] = useState<Shown | null>(null); // of a live board, while it moves
  const resting = useRef(0), dropping = useRef(0);
  const [dragged, setDragged] = useState<number[] | null>(null); // cursors, while one moves
  const inAddress = useMemo(() => rangeFrom(time) ?? (live ? { follow: FOLLOW_S } : "whole" as const), [time, live]);
  const inText = useMemo(() => numbersFrom(marks), [marks]), cursors = dragged ?? inText;
  const put = useCallback((name: string, value: string | null) => {
    const changed = new URLSearchParams(location.search);
    if (value) changed.set(name, value); else changed.delete(name);
    setQuery(changed);
  }, []);
  useEffect(() => () => { clearTimeout(resting.current); clearTimeout(dropping.current); }, []);
  const rest = (changed: Shown) => {
    clearTimeout(resting.current);
    resting.current = window.setTimeout(() => {
      put("t", changed === "whole" && !live ? null : rangeText(changed));
      setMoving(null);
    }, typeof changed === "object" && "from" in changed ? REST_MS : 0);
  };
  return {
    plots,
    shown: moving ?? inAddress,
    cursors,
    chosen: Math.min(chosen, Math.max(0, cursors.length - 1)),
    setPlots: (changed) => {
      keep(layoutText(changed));
      put("plots", layoutText(changed));
    },
    setShown: (changed) => {
      if (live) setMoving(changed); // what follows is held at once
      rest(changed);
    },
    setCursors: (changed, which) => {
      if (which !== undefined) setChosen(which);
      clearTimeout(dropping.current);
      const drop = () => { put("c", numbersText(changed)); setDragged(null); };
      if (changed.length !== cursors.length) { drop(); return; }
      setDragged(changed);
      dropping.current = window.setTimeout(drop, REST_MS);
    },
    reset: () => {
      keep("");
      put("plots", null);
    },
  };
}

// The plots that were chosen for runs of a plan; '' for the usual ones, which are shown until the answer is there.
function useKept(plan: string): [string, (text: string) => void] {
  const [text, setText] = useState("");
  const path = `/layouts/${encodeURIComponent(plan)}`;
  useEffect(() => {
    const control = new AbortController();
    get<Layout>(path, control.signal).then((found) => setText(found.text ?? "")).catch(() => {});
    return () => control.abort();
  }, [path]);
  return [text, (changed) => {
    setText(changed);
    ask("PUT", path, { text: changed }).catch(() => {}); // the address has them, too
  }];
}
