// What takes the service longer than a hand moves: asked when the hand rests, one question at a time, the newest next.

import { useEffect, useRef, useState } from "preact/hooks";
import { post } from "../../api/client.ts";

const REST_MS = 350;

export interface Rested<T> {
  data: T | null; // of what is asked now; null while it is awaited
  error: Error | null;
  awaited: boolean;
}

interface Answer<T> {
  key: string;
  data: T | null;
  error: Error | null;
}

export function useRested<T>(path: string, body: object | null): Rested<T> {
  const key = body === null ? "" : JSON.stringify(body);
  const [found, setFound] = useState<Answer<T>>({ key: "", data: null, error: null });
  const wanted = useRef(""), busy = useRef(false);
  useEffect(() => {
    wanted.current = key;
    if (!key) return undefined;
    const follow = async () => {
      if (busy.current) return;
      busy.current = true;
      for (let asked = ""; wanted.current && wanted.current !== asked;) {
        asked = wanted.current;
        const answer = await post<T>(path, JSON.parse(asked) as object).then((data) => ({ data, error: null }), (error: Error) => ({ data: null, error }));
        if (wanted.current) setFound({ key: asked, ...answer });
      }
      busy.current = false;
    };
    const timer = setTimeout(() => void follow(), REST_MS);
    return () => { clearTimeout(timer); };
  }, [path, key]);
  useEffect(() => () => { wanted.current = ""; }, []);
  const mine = found.key === key;
  return { data: mine && key ? found.data : null, error: mine && key ? found.error : null, awaited: key !== "" && !mine };
}
