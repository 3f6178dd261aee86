// Filters, order and page of the table of runs, as they stand in its address and as the service is asked.

export const ORDERS = ["run", "plan", "bench", "dut", "verdict", "ended", "duration", "value"] as const;
export type Order = (typeof ORDERS)[number];

export const FILTERS = ["plan", "bench", "dut", "verdict", "requested_by", "state", "tag"] as const;
export type Filter = (typeof FILTERS)[number];

export const VERDICTS = ["pass", "fail", "error", "done"];
export const STATES = ["waiting_approval", "queued", "running", "ended", "interrupted", "cancelled"];

export const PAGE = 50;

export interface RunsQuery {
  filters: Record<Filter, string>;
  text: string;
  since: string; // days, as an input of type date has them
  until: string;
  criterion: string;
  above: string;
  below: string;
  sort: Order;
  rising: boolean;
  page: number; // from 1
  chosen: number[]; // runs that are ticked to be compared
}

const MOST_COMPARED = 6;

export function queryFrom(query: URLSearchParams): RunsQuery {
  const text = (name: string): string => query.get(name) ?? "";
  return {
    filters: Object.fromEntries(FILTERS.map((name) => [name, text(name)])) as Record<Filter, string>,
    text: text("text"),
    since: dayOf(text("since")),
    until: dayOf(text("until")),
    criterion: text("criterion"),
    above: numberText(text("above")),
    below: numberText(text("below")),
    sort: ORDERS.find((one) => one === text("sort")) ?? "run",
    rising: text("rising") === "true",
    page: Math.max(1, Math.floor(Number(text("page"))) || 1),
    chosen: [...new Set(text("chosen").split(",").filter((one) => /^[1-9]\d{0,9}$/.test(one)).map(Number))].slice(0, MOST_COMPARED),
  };
}

const dayOf = (text: string): string => (/^\d{4}-\d{2}-\d{2}$/.test(text) ? text : "");
const numberText = (text: string): string => (text !== "" && Number.isFinite(Number(text)) ? text : "");

// What an address asks for that no run can have.
export function impossibleIn({ filters: { verdict, state } }: RunsQuery): { filter: "verdict" | "state"; name: string } | null {
  if (verdict && !VERDICTS.includes(verdict)) return { filter: "verdict", name: verdict };
  return state && !STATES.includes(state) ? { filter: "state", name: state } : null;
}

// Only what is not usual stands in the address.
export function toAddress(query: RunsQuery): URLSearchParams {
  const all: Record<string, string> = {
    ...query.filters, text: query.text, since: query.since, until: query.until, criterion: query.criterion, above: query.above, below: query.below,
    sort: query.sort === "run" ? "" : query.sort, rising: query.rising ? "true" : "", page: query.page > 1 ? String(query.page) : "", chosen: query.chosen.join(","),
  };
  return new URLSearchParams(Object.entries(all).filter(([, value]) => value !== ""));
}

// Days are those of the browser's zone; the last one is in.
export function toService(query: RunsQuery): URLSearchParams {
  const asked = toAddress({ ...query, page: 1, chosen: [] });
  if (query.since) asked.set("since", midnight(query.since, 0));
  if (query.until) asked.set("until", midnight(query.until, 1));
  if (!query.criterion) { asked.delete("above"); asked.delete("below"); }
  asked.set("first", String(PAGE * (query.page - 1)));
  asked.set("most", String(PAGE));
  return asked;
}

function midnight(day: string, daysLater: number): string {
  const [year = 0, month = 1, date = 1] = day.split("-").map(Number);
  return new Date(year, month - 1, date + daysLater).toISOString();
}

// A column that is chosen again turns its order round; numbers and dates begin with the largest.
export function sorted(query: RunsQuery, by: Order): RunsQuery {
  const usual = by === "plan" || by === "bench" || by === "dut" || by === "verdict";
  return { ...query, page: 1, sort: by, rising: query.sort === by ? !query.rising : usual };
}

// One run ticked, or no longer; of too many the newest stay.
export const ticked = (query: RunsQuery, run: number): RunsQuery =>
  ({ ...query, chosen: query.chosen.includes(run) ? query.chosen.filter((one) => one !== run) : [...query.chosen, run].slice(-MOST_COMPARED) });
