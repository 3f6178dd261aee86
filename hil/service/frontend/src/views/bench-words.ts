// States of a bench in words.

import type { Bench } from "../api/types.ts";

export const STATES: Record<Bench["state"], string> = {
  free: "Free", running: "Running", ending: "Ending a lost run", in_use: "In use", emergency_stop: "Emergency stop", away: "Agent not connected",
};

export function headlineOf(bench: Bench, title: string | null): string {
  if (bench.stop_confirmed === false) return "Emergency stop asked for, NOT CONFIRMED";
  if (title !== null && bench.state === "running") return `Running: ${title}`;
  return STATES[bench.state];
}
