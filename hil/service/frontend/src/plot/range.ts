// The stretch of time that is shown: it follows what is measured, or holds where somebody looks.

export interface Range {
  from: number;
  to: number;
}

export type Shown = { follow: number } | Range | "whole";

const CLOSEST_S = 0.005;

export const isFollowing = (shown: Shown): shown is { follow: number } => typeof shown === "object" && "follow" in shown;

export function rangeOf(shown: Shown, first: number, last: number): Range {
  if (shown === "whole") return { from: first, to: Math.max(last, first + 1) };
  if (isFollowing(shown)) return last - first < shown.follow ? { from: first, to: first + shown.follow } : { from: last - shown.follow, to: last };
  return shown;
}

// Closer or farther around a place that stays where it is.
export function zoomed(range: Range, factor: number, around = 0.5 * (range.from + range.to)): Range {
  const scale = Math.max(factor, CLOSEST_S / (range.to - range.from));
  return { from: around + scale * (range.from - around), to: around + scale * (range.to - around) };
}

export function panned(range: Range, share: number): Range {
  const by = share * (range.to - range.from);
  return { from: range.from + by, to: range.to + by };
}

const inAddress = (seconds: number): string => String(Number(seconds.toFixed(4)));

export function rangeText(shown: Shown): string {
  if (shown === "whole") return "whole";
  return isFollowing(shown) ? `last${inAddress(shown.follow)}` : `${inAddress(shown.from)},${inAddress(shown.to)}`;
}

export function rangeFrom(text: string | null): Shown | null {
  if (text === null) return null;
  if (text === "whole") return "whole";
  const last = /^last(\d+(?:\.\d+)?)$/.exec(text);
  if (last) return { follow: Math.max(1, Number(last[1])) };
  const [from, to, more] = text.split(",").map(Number);
  return from !== undefined && to !== undefined && more === undefined && to > from && isMoment(from) && isMoment(to) ? { from, to } : null;
}

// A moment of a run can be that; others stand in an address that somebody made up.
const isMoment = (seconds: number): boolean => seconds >= -1e6 && seconds <= 1e9;

export const numbersFrom = (text: string | null): number[] => (text ?? "").split(",").filter(Boolean).map(Number).filter(isMoment).slice(0, 6);
export const numbersText = (values: readonly number[]): string => values.map(inAddress).join(",");

// Places on a logarithmic axis: one to nine of each decade. uPlot's own never end where a range begins just below a decade.
export function decades(low: number, high: number): number[] {
  if (!(low > 0) || !(high >= low) || !Number.isFinite(high)) return [];
  const found: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) {
    for (let digit = 1; digit <= 9; digit += 1) {
      const place = Number(`${digit}e${power}`);
      if (place >= low && place <= high) found.push(place);
    }
  }
  return found;
}
