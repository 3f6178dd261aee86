// What the service answers, kept while it is asked again; and work that may be refused.

import { useCallback, useEffect, useRef, useState } from "preact/hooks";
import { get, Refused, SignedOut } from "./api/client.ts";
import { Store } from "./store.ts";

export interface Asked<T> {
  data: T | null;
  error: Error | null;
  loading: boolean;
  again: () => void;
}

// The answer of a path, asked again every so many milliseconds while the page is in sight; null asks nothing.
export function useData<T>(path: string | null, everyMs = 0): Asked<T> {
  const [found, setFound] = useState<{ path: string | null; data: T | null; error: Error | null; loading: boolean }>({ path, data: null, error: null, loading: path !== null });
  const [turn, setTurn] = useState(0);
  const shown = useRef("");
  useEffect(() => {
    if (path === null) return undefined;
    const control = new AbortController();
    const look = async () => {
      try {
        const data = await get<T>(path, control.signal);
        const text = JSON.stringify(data);
        if (text === shown.current) return;
        shown.current = text;
        setFound({ path, data, error: null, loading: false });
      } catch (error) {
        shown.current = "";
        if (!control.signal.aborted) setFound((before) => ({ path, data: before.path === path ? before.data : null, error: error as Error, loading: false }));
      }
    };
    shown.current = "";
    setFound((before) => ({ ...before, loading: true }));
    void look();
    const timer = everyMs ? setInterval(() => { if (!document.hidden) void look(); }, everyMs) : 0;
    return () => { control.abort(); clearInterval(timer); };
  }, [path, everyMs, turn]);
  const again = useCallback(() => setTurn((one) => one + 1), []);
  const mine = found.path === path;
  return { data: mine ? found.data : null, error: mine ? found.error : null, loading: found.loading || !mine, again };
}

// Whether the service has answered that there is no such thing, or that nothing can have this name.
export const isMissing = ({ error }: { error: Error | null }): boolean => error instanceof Refused && [404, 422].includes(error.status);

// What was refused last, shown above every view until something else is done.
export const refusal = new Store<Error | null>(null);

// `at`: where a refusal is shown, if not above the view.
export async function attempt<T>(work: () => Promise<T> | T, at: Store<Error | null> = refusal): Promise<T | null> {
  refusal.value = at.value = null;
  try {
    return await work();
  } catch (error) {
    const isGone = error instanceof DOMException && error.name === "AbortError"; // nobody waits for it any more
    if (!isGone && !(error instanceof SignedOut)) at.value = error as Error;
    return null;
  }
}
