// What a board of plots shows: kept in the address, so that it can be sent, and per person and plan in this browser.

import { useCallback, useMemo, useState } from "preact/hooks";
import { setQuery, useQuery } from "../router.ts";
import { useMe } from "../session.ts";
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

export function useBoardState(plan: string, channels: readonly string[], live: boolean): BoardState {
  const [query] = useQuery();
  const me = useMe();
  const key = `layout ${me.name} ${plan}`;
  const [chosen, setChosen] = useState(0);
  const text = query.get("plots") ?? localStorage.getItem(key);
  const known = channels.join(",");
  const plots = useMemo(() => (text ? layoutOf(text).map((plot) => ({ ...plot, channels: plot.channels.filter((one) => channels.includes(one)) })) : usualLayout(channels)), [text, known]);
  const time = query.get("t"), marks = query.get("c");
  const shown = useMemo(() => rangeFrom(time) ?? (live ? { follow: FOLLOW_S } : "whole" as const), [time, live]);
  const cursors = useMemo(() => numbersFrom(marks), [marks]);
  const put = useCallback((name: string, value: string | null) => {
    const changed = new URLSearchParams(location.search);
    if (value) changed.set(name, value); else changed.delete(name);
    setQuery(changed);
  }, []);
  return {
    plots,
    shown,
    cursors,
    chosen: Math.min(chosen, Math.max(0, cursors.length - 1)),
    setPlots: (changed) => {
      localStorage.setItem(key, layoutText(changed));
      put("plots", layoutText(changed));
    },
    setShown: (changed) => put("t", changed === "whole" && !live ? null : rangeText(changed)),
    setCursors: (changed, which) => {
      if (which !== undefined) setChosen(which);
      put("c", numbersText(changed));
    },
    reset: () => {
      localStorage.removeItem(key);
      put("plots", null);
    },
  };
}
