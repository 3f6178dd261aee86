// What the service says of a text, asked for when nothing has been typed for a moment.

import { useEffect, useState } from "preact/hooks";
import { post } from "../api/client.ts";

const WAIT_MS = 300;

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
    let current = true;
    const look = async () => {
      try {
        const check = await post<T>(path, asked);
        if (current) setChecked({ text: asked.text, check, error: "" });
      } catch (error) {
        if (current) setChecked({ text: asked.text, check: null, error: (error as Error).message });
      }
    };
    const timer = setTimeout(() => void look(), WAIT_MS);
    return () => { current = false; clearTimeout(timer); };
  }, [path, key]);
  return checked;
}
