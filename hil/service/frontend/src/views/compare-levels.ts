// Limits of criteria that are levels of a channel: drawn where runs are laid over each other.

import type { RunView } from "../api/types.ts";
import { namedBy } from "./criterion-words.ts";

export interface Level {
  value: number;
  failed: boolean; // by one of the runs: then it is in sight
}

type Judged = Pick<RunView["criteria"][number], "id" | "upper" | "lower" | "verdict">;

// Metrics that are a value of a channel at some moment; of a duration or an energy no line can be drawn.
const OF_SHAFT_TORQUE = ["peak_shaft_torque"];
const OF_ANY = /^(?<segment>.+)\.(?<metric>peak|trough|magnitude)\.(?<channel>\w+)$/;

// Segment, channel and values that a criterion limits; null where it limits no value of a channel.
export function limitedBy({ id, upper, lower }: Pick<Judged, "id" | "upper" | "lower">): { segment: string; channel: string; values: number[] } | null {
  const named = namedBy(id), own = OF_ANY.exec(id)?.groups, values = [upper, lower].filter((limit): limit is number => limit != null);
  if (own) return { segment: own["segment"] ?? "", channel: own["channel"] ?? "", values: own["metric"] === "magnitude" ? values.flatMap((limit) => [limit, -limit]) : values };
  return OF_SHAFT_TORQUE.includes(named.metric) ? { segment: named.segment, channel: "shaft_torque_nm", values } : null;
}

// The first of these segments that one of the runs failed in; '' for none.
export const failedIn = (views: readonly { criteria: readonly Judged[] }[], segments: readonly string[]): string =>
  segments.find((segment) => views.some(({ criteria }) => criteria.some(({ id, verdict }) => verdict === "fail" && namedBy(id).segment === segment))) ?? "";

export function levelsOf(views: readonly { criteria: readonly Judged[] }[], segment: string, channel: string): Level[] {
  const found = new Map<number, boolean>();
  for (const one of views.flatMap(({ criteria }) => criteria)) {
    const of = limitedBy(one);
    if (of?.channel !== channel || of.segment !== segment) continue;
    for (const value of of.values) found.set(value, (found.get(value) ?? false) || one.verdict === "fail");
  }
  return [...found].map(([value, failed]) => ({ value, failed })).sort((one, other) => one.value - other.value);
}
