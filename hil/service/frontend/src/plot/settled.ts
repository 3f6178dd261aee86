// A range that does not move with every sample: while plots follow, what takes longer looks once a second at the last 8 s.

import { useEffect, useRef, useState } from "preact/hooks";
import type { Range } from "./range.ts";

const EVERY_MS = 1000;
const LAST_S = 8;

export function useSettled(range: Range, following: boolean): Range {
  const now = useRef(range);
  now.current = range;
  const [settled, setSettled] = useState(range);
  useEffect(() => {
    if (!following) return undefined;
    const look = () => setSettled({ from: Math.max(now.current.from, now.current.to - LAST_S), to: now.current.to });
    look();
    const timer = setInterval(look, EVERY_MS);
    return () => clearInterval(timer);
  }, [following]);
  return following ? settled : range;
}
