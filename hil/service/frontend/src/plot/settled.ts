// A range that does not move with every sample: while plots follow, what takes longer looks once a second at the last 8 s.

import { useEffect, useState } from "preact/hooks";
import type { Store } from "../store.ts";
import type { Range } from "./range.ts";

const LAST_S = 8;
const LEAST_S = 0.2; // of which a spectrum says anything

// Null where too little was measured in it.
export function useSettled(range: Store<Range>, following: boolean, last: number): Range | null {
  const [settled, setSettled] = useState(range.value);
  useEffect(() => {
    const look = () => {
      const { from, to } = range.value;
      setSettled(following ? { from: Math.max(from, Math.min(to, last) - LAST_S), to: Math.min(to, last) } : range.value);
    };
    look();
    return following ? undefined : range.subscribe(look);
  }, [range, following, following ? Math.floor(last) : 0]);
  return Math.min(settled.to, last) - settled.from < LEAST_S ? null : settled;
}
