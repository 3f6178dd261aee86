// Since when somebody wants to know what happened: their last visit with this browser, a day at least, a week at most.

const HOUR_MS = 3_600_000;
const LEAST_MS = 24 * HOUR_MS, MOST_MS = 7 * 24 * HOUR_MS;
const KEY = "visits";

export interface Visits {
  seenMs: number; // when the list of benches was looked at last
  sinceMs: number; // the end of the visit before
}

// A look within an hour of the last is of the same visit.
export function visitedAt(kept: Visits | null, nowMs: number): Visits {
  const before = !kept ? nowMs : nowMs - kept.seenMs > HOUR_MS ? kept.seenMs : kept.sinceMs;
  return { seenMs: nowMs, sinceMs: Math.max(nowMs - MOST_MS, Math.min(before, nowMs - LEAST_MS)) };
}

export function visit(): Visits {
  const now = visitedAt(kept(), Date.now());
  try {
    localStorage.setItem(KEY, JSON.stringify(now));
  } catch { // a browser that keeps nothing: a day then
  }
  return now;
}

function kept(): Visits | null {
  try {
    const { seenMs, sinceMs } = JSON.parse(localStorage.getItem(KEY) ?? "") as Visits;
    return Number.isFinite(seenMs) && Number.isFinite(sinceMs) ? { seenMs, sinceMs } : null;
  } catch {
    return null;
  }
}
