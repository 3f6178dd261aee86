// How two runs differ: of a criterion the other minus the first, in its unit, and whether that is better; of what they
// were given what is said in sentences, and what stands in the table.

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

const SAID = 4;
const NAMES = ["name", "title", "description"]; // called otherwise, not otherwise done

export const keyOf = (one: Difference): string => `${one.kind} ${one.name}`;

export const ofPlan = ({ differences }: Pick<Comparison, "differences">): Difference[] => differences.filter((one) => one.kind === "plan" && !NAMES.includes(one.name));

export const saidOf = (pair: Pick<Comparison, "differences">): Difference[] => ofPlan(pair).slice(0, SAID);

// Nothing is said twice.
export function tabledOf(pair: Pick<Comparison, "differences">): Difference[] {
  const said = saidOf(pair);
  return pair.differences.filter((one) => !said.includes(one));
}
