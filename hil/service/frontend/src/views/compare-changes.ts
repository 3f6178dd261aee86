// How two runs differ: of a criterion the other minus the first, in its unit, and whether that is better; of what they
// were given what stands in the table.

import type { Comparison } from "../api/types.ts";
import { figure, percent } from "../format.ts";

export interface Change {
  by: number; // the other minus the first
  kind: "better" | "worse" | "same" | "open"; // open: its limits say no direction
}

type Row = Comparison["criteria"][number];

// Null where either run has no value.
export function changeOf({ values: [first, other], better }: Pick<Row, "values" | "better">): Change | null {
  if (first == null || other == null) return null;
  const by = other - first;
  if (by === 0) return { by, kind: "same" };
  return { by, kind: better ? ((by < 0) === (better === "lower") ? "better" : "worse") : "open" };
}

const signed = (value: number, text: string): string => (value > 0 ? `+${text}` : text);

// With its sign and unit; in per cent of the first, too, where that is not zero.
export function changeText({ by }: Change, { unit, relative }: Pick<Row, "unit" | "relative">): string {
  const own = signed(by, figure(by, unit));
  return relative == null ? own : `${own} (${signed(relative, percent(relative, 1))})`;
}

export type Difference = Comparison["differences"][number];

export const keyOf = (one: Difference): string => `${one.kind} ${one.name}`;

// Nothing stands twice: what the service puts into the sentence about the plan is not in the table.
export function tabledOf({ differences, plan_summary: summary }: Pick<Comparison, "differences" | "plan_summary">): Difference[] {
  const shown = new Set(summary.map(keyOf));
  return differences.filter((one) => !shown.has(keyOf(one)));
}
