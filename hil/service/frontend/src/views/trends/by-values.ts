// Runs of a plan by the values of its variables.

import type { Run } from "../../api/types.ts";
import { valuesOf } from "../runs/run-values.ts";

export interface SameValues {
  run: number; // the newest of them
  values: string;
  count: number;
}

// Newest first. What a run did not set had the plan's own value.
export function groupsOf(runs: readonly Pick<Run, "id" | "values">[], usual: Record<string, number>): SameValues[] {
  const found = new Map<string, SameValues>();
  for (const { id, values: set } of [...runs].sort((one, other) => other.id - one.id)) {
    const values = valuesOf({ values: { ...usual, ...set } }), known = found.get(values);
    if (known) known.count += 1;
    else found.set(values, { run: id, values, count: 1 });
  }
  return [...found.values()];
}
