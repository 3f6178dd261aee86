// Moments as fields of a form have them: the browser's own time, to the minute, without a zone.

import { t } from "../../i18n/text.ts";

const two = (value: number): string => String(value).padStart(2, "0");

export const dayOf = (at: Date): string => `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;

export const fieldOf = (at: Date): string => `${dayOf(at)}T${two(at.getHours())}:${two(at.getMinutes())}`;

// With its zone, as the service wants it; null for what is no moment.
export function momentOf(field: string): string | null {
  const at = new Date(field);
  return field && Number.isFinite(at.getTime()) ? at.toISOString() : null;
}

const DAY_MS = 24 * 3_600_000, YEAR_DAYS = 366, LONGEST_DAYS = 31;

// The first and the last moment that somebody may mean.
export const spanAround = (now: Date): [Date, Date] => [new Date(now.getTime() - DAY_MS), new Date(now.getTime() + YEAR_DAYS * DAY_MS)];

// What is wrong with a bench wanted from a moment to another; '' if nothing is, or if one is not written yet.
export function spanProblem(begins: string, ends: string, now: Date): string {
  const from = new Date(begins), to = new Date(ends), [first, last] = spanAround(now);
  if (Number.isNaN(from.getTime()) || Number.isNaN(to.getTime())) return "";
  if (from < first) return t("“From” is more than a day ago.");
  if (to > last) return t("“To” is more than a year ahead.");
  if (to <= from) return t("“To” must be later than “From”.");
  return to.getTime() - from.getTime() > LONGEST_DAYS * DAY_MS ? t("A bench is reserved for 31 days at most.") : "";
}

// The next whole hour: from then on somebody may want a bench.
export function nextHour(now: Date): Date {
  const at = new Date(now);
  at.setHours(at.getHours() + 1, 0, 0, 0);
  return at;
}

export type Shift = "early" | "day" | "late" | "night";

// The shift that somebody who writes at this hour most likely means.
export function shiftAt(now: Date): Shift {
  const hour = now.getHours();
  return hour >= 6 && hour < 14 ? "early" : hour >= 14 && hour < 22 ? "late" : "night";
}
