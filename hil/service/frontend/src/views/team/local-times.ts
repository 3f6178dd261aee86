// Moments as fields of a form have them: the browser's own time, to the minute, without a zone.

const two = (value: number): string => String(value).padStart(2, "0");

export const dayOf = (at: Date): string => `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;

export const fieldOf = (at: Date): string => `${dayOf(at)}T${two(at.getHours())}:${two(at.getMinutes())}`;

// With its zone, as the service wants it; null for what is no moment.
export function momentOf(field: string): string | null {
  const at = new Date(field);
  return field && Number.isFinite(at.getTime()) ? at.toISOString() : null;
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
