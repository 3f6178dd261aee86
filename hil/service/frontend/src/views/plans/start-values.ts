// What a plan is started with, in its address: the bench and the values of an earlier run.

import type { Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import type { StartedFrom } from "./start-plan.tsx";

const VALUE = "value.";

export const againWith = (run: Pick<Run, "plan" | "bench" | "values">): string =>
  `${to.plan(run.plan)}?${new URLSearchParams([["bench", run.bench], ...Object.entries(run.values).map(([name, value]) => [VALUE + name, String(value)])])}`;

export function valuesFrom(query: URLSearchParams): StartedFrom {
  const values = [...query].filter(([name, text]) => name.startsWith(VALUE) && text !== "" && Number.isFinite(Number(text)));
  return { bench: query.get("bench") ?? "", values: Object.fromEntries(values.map(([name, text]) => [name.slice(VALUE.length), text])) };
}
