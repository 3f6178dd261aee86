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

function channelOf({ id }: Judged, segment: string): { channel: string; bothSides: boolean } | null {
  const named = namedBy(id), own = OF_ANY.exec(id)?.groups;
  if (own) return own["segment"] === segment ? { channel: own["channel"] ?? "", bothSides: own["metric"] === "magnitude" } : null;
  return named.segment === segment && OF_SHAFT_TORQUE.includes(named.metric) ? { channel: "shaft_torque_nm", bothSides: false } : null;
}

export function levelsOf(views: readonly { criteria: readonly Judged[] }[], segment: string, channel: string): Level[] {
  const found = new Map<number, boolean>();
  for (const one of views.flatMap(({ criteria }) => criteria)) {
    const of = channelOf(one, segment);
    if (of?.channel !== channel) continue;
    const limits = [one.upper, one.lower].filter((limit): limit is number => limit != null);
    for (const value of of.bothSides ? limits.flatMap((limit) => [limit, -limit]) : limits) found.set(value, (found.get(value) ?? false) || one.verdict === "fail");
  }
  return [...found].map(([value, failed]) => ({ value, failed })).sort((one, other) => one.value - other.value);
}
