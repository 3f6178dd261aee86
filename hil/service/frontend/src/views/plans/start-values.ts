// What a plan is started with, in the address: the plan or the bench that is chosen, and values of the plan's variables.

import type { Run } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import type { Texts } from "./typed-values.ts";

export interface Start {
  plan: string; // '' where none is chosen, or the address is that of a plan
  bench: string; // as well
  values: Texts;
}

const VALUE = "value.";

export const againWith = (run: Pick<Run, "plan" | "bench" | "values">): string =>
  `${to.plan(run.plan)}?${new URLSearchParams([["bench", run.bench], ...Object.entries(run.values).map(([name, value]) => [VALUE + name, String(value)])])}`;

export function startFrom(query: URLSearchParams): Start {
  const values = [...query].filter(([name, text]) => name.startsWith(VALUE) && text !== "" && Number.isFinite(Number(text)));
  return { plan: query.get("plan") ?? "", bench: query.get("bench") ?? "", values: Object.fromEntries(values.map(([name, text]) => [name.slice(VALUE.length), text])) };
}

// A query with another start in it; what else stands there stays.
export function withStart(query: URLSearchParams, { plan, bench, values }: Start): URLSearchParams {
  const others = [...query].filter(([name]) => name !== "plan" && name !== "bench" && !name.startsWith(VALUE));
  const own = [["plan", plan], ["bench", bench], ...Object.entries(values).map(([name, text]) => [VALUE + name, text])].filter(([, text]) => text !== "");
  return new URLSearchParams([...others, ...own] as string[][]);
}
