// What a screen on a wall shows: asked again and again, with the moment at which the service was last heard of.

import { useEffect, useState } from "preact/hooks";
import { get, Refused } from "../api/client.ts";
import type { Bench, FoundRuns, Run } from "../api/types.ts";
import { lookWho } from "../session.ts";

export interface Shown {
  bench: Bench;
  running: Run | null;
  queue: Run[];
  latest: Run[];
}

export interface Heard {
  shown: Shown[];
  missing: boolean; // the bench of the address is none of the service's
  atMs: number; // by the clock of performance.now(); 0: never
}

const AGAIN_MS = 2000;
const PATIENCE_MS = 5000;
const LATEST = 6;

// One request for all benches, and three for each.
async function look(only: string | null): Promise<Pick<Heard, "shown" | "missing">> {
  const signal = AbortSignal.timeout(PATIENCE_MS);
  const benches = (await get<Bench[]>("/benches", signal)).filter((bench) => only === null || bench.name === only);
  const shown = await Promise.all(benches.map(async (bench): Promise<Shown> => {
    const [running, queue, found] = await Promise.all([
      bench.running ? get<Run>(`/runs/${bench.running}`, signal) : null,
      get<Run[]>(`/benches/${encodeURIComponent(bench.name)}/queue`, signal),
      get<FoundRuns>(`/run-list?${queryOf(bench.name)}`, signal),
    ]);
    return { bench, running, queue, latest: found.runs.map(({ run }) => run) };
  }));
  return { shown, missing: only !== null && benches.length === 0 };
}

const queryOf = (bench: string): URLSearchParams =>
  new URLSearchParams([["bench", bench], ["most", String(LATEST)], ...["ended", "interrupted"].map((state) => ["state", state])] as string[][]);

export function useWall(only: string | null): Heard {
  const [heard, setHeard] = useState<Heard>({ shown: [], missing: false, atMs: 0 });
  useEffect(() => {
    let timer = 0, open = true;
    const again = async () => {
      try {
        const found = await look(only);
        if (open) setHeard({ ...found, atMs: performance.now() });
      } catch (error) { // what is shown stays, and grows old
        if (open && error instanceof Refused && error.status === 401) void lookWho();
      }
      if (open) timer = window.setTimeout(() => void again(), AGAIN_MS);
    };
    void again();
    return () => { open = false; clearTimeout(timer); };
  }, [only]);
  return heard;
}
