// What the service says of a text, asked for when nothing has been typed for a moment.

import { useEffect, useState } from "preact/hooks";
import { post, Refused } from "../api/client.ts";

const WAIT_MS = 300;
const AGAIN_MS = 2000;
const AWAY = [0, 502, 503, 504]; // the service is away, or is just being ended

export interface Checked<T> {
  text: string; // of which this is known
  check: T | null;
  error: string;
}

// Null asks nothing: there is no name yet.
export function useCheck<T>(path: string, asked: ({ text: string } & Record<string, unknown>) | null): Checked<T> {
  const [checked, setChecked] = useState<Checked<T>>({ text: "", check: null, error: "" }), key = JSON.stringify(asked);
  useEffect(() => {
    if (asked === null) return undefined;
    let current = true, timer = 0;
    const look = async () => {
      try {
        const check = await post<T>(path, asked);
        if (current) setChecked({ text: asked.text, check, error: "" });
      } catch (error) {
        if (!current) return;
        setChecked({ text: asked.text, check: null, error: (error as Error).message });
        if (error instanceof Refused && AWAY.includes(error.status)) timer = window.setTimeout(() => void look(), AGAIN_MS);
      }
    };
    timer = window.setTimeout(() => void look(), WAIT_MS);
    return () => { current = false; clearTimeout(timer); };
  }, [path, key]);
  return checked;
}
