// What the service draws of drafts, as they are moved: one question at a time, of the newest that are wanted.

import { useEffect, useRef, useState } from "preact/hooks";
import { post, Refused } from "../../api/client.ts";
import type { DraftData } from "../../api/types.ts";

export interface Drawn {
  found: DraftData | null; // the last of this place while the newest is awaited
  error: Error | null;
}

const KEPT = 40;

export function useDrafts(bodies: (object | null)[]): Drawn[] {
  const keys = bodies.map((one) => (one === null ? "" : JSON.stringify(one)));
  const known = useRef(new Map<string, DraftData | Error>()), last = useRef<(DraftData | null)[]>([]);
  const wanted = useRef<string[]>([]), busy = useRef(false), open = useRef(true);
  const [, setTurn] = useState(0);
  const all = keys.join("\n");
  useEffect(() => {
    wanted.current = keys;
    forgetFailures(known.current);
    const follow = async () => {
      busy.current = true;
      for (let key = missing(wanted.current, known.current); key; key = missing(wanted.current, known.current)) {
        known.current.set(key, await drawn(key));
        if (known.current.size > KEPT) known.current.delete(known.current.keys().next().value as string);
        if (open.current) setTurn((one) => one + 1);
      }
      busy.current = false;
    };
    if (!busy.current) void follow();
  }, [all]);
  useEffect(() => () => { open.current = false; wanted.current = []; }, []);
  return keys.map((key, at) => {
    const answer = known.current.get(key);
    if (answer && !(answer instanceof Error)) last.current[at] = answer;
    return { found: last.current[at] ?? null, error: answer instanceof Error ? answer : null };
  });
}

// What was refused for its numbers stays so; what failed otherwise is asked again with the next move.
function forgetFailures(known: Map<string, DraftData | Error>): void {
  for (const [key, one] of known) if (one instanceof Error && !(one instanceof Refused && one.status === 422)) known.delete(key);
}

const missing = (wanted: string[], known: Map<string, unknown>): string | undefined => wanted.find((key) => key !== "" && !known.has(key));

const drawn = (key: string): Promise<DraftData | Error> => post<DraftData>("/drafts", JSON.parse(key) as object).catch((error: Error) => error);
