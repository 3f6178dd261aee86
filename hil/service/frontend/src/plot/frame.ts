// What all plots have in common: axes in the colours of the page, and a size that follows their place.

import type uPlot from "uplot";
import { colour } from "../theme.ts";
import { digitsOf, figure, fixed } from "../format.ts";

export const ROLES = ["gain", "phase", "third", "fourth", "fifth", "reference", "measured"] as const;
export const roleOf = (at: number): string => ROLES[at % ROLES.length] ?? "gain";
export const HEIGHT = 210;

const ticks = (values: readonly (number | null)[]): string[] => {
  const there = values.filter((one): one is number => one !== null);
  const step = there.length > 1 ? Math.abs((there[1] as number) - (there[0] as number)) : 1;
  const digits = digitsOf(step);
  return values.map((one) => (one === null ? "" : Math.abs(one) >= 1e6 || (step < 1e-5 && one !== 0) ? figure(one) : fixed(one, digits).replace("-", "−")));
};

export function axis(options: Partial<uPlot.Axis> & { unit?: string }): uPlot.Axis {
  const { unit, ...more } = options;
  return {
    stroke: () => colour("quiet"),
    grid: { stroke: () => colour("grid"), width: 1 },
    ticks: { stroke: () => colour("grid"), width: 1, size: 4 },
    font: "12px sans-serif",
    labelFont: "12px sans-serif",
    values: (_, values) => ticks(values),
    ...(unit ? { label: unit, labelSize: 16, labelGap: 0 } : {}),
    ...more,
  };
}

// A range with some room around its values; never of no height.
export function roomy(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const room = Math.max(high - low, 1e-3 * Math.max(Math.abs(high), Math.abs(low)), 1e-6);
  return [low - 0.06 * room, high + 0.1 * room];
}

// With values that must be in sight, too.
export const reaching = (low: number | null, high: number | null, values: readonly number[]): [number | null, number | null] =>
  low === null || high === null ? [low, high] : [Math.min(low, ...values), Math.max(high, ...values)];

// Draws when an element is in sight, and what was left out meanwhile once it comes into sight.
export function inSight(element: HTMLElement, draw: () => void): { ask: () => void; stop: () => void } {
  let seen = true, left = false;
  const observer = new IntersectionObserver(([one]) => {
    seen = one?.isIntersecting ?? true;
    if (seen && left) { left = false; draw(); }
  }, { rootMargin: "100px" });
  observer.observe(element);
  return { ask: () => { if (seen) draw(); else left = true; }, stop: () => observer.disconnect() };
}

// Calls with the width of an element whenever that changes.
export function onWidth(element: HTMLElement, take: (width: number) => void): () => void {
  const observer = new ResizeObserver(() => { if (element.clientWidth > 0) take(element.clientWidth); });
  observer.observe(element);
  return () => observer.disconnect();
}
