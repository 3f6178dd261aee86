// Lines at limits of what is plotted: whose they are, where they hold, and which of them the run failed.

import { figure, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import type { Range } from "./range.ts";

export interface ChannelLimit {
  channel: string;
  value: number;
  what: string; // the criterion in words; '' of a limit of the bench
  failed: boolean;
  holds: Range | null; // null: always
}

export interface LimitMark {
  value: number;
  label: string;
  failed: boolean;
  holds: Range | null;
}

// Of channels on one scale: what lies at the same place is one line, named by all of them.
export function marksOf(limits: readonly ChannelLimit[], channels: readonly string[], unit: string): LimitMark[] {
  const found = new Map<string, ChannelLimit[]>();
  for (const one of limits) {
    if (!channels.includes(one.channel)) continue;
    const key = JSON.stringify([one.value, one.what, one.failed, one.holds]);
    found.set(key, [...(found.get(key) ?? []), one]);
  }
  return [...found.values()].map((same) => {
    const { value, what, failed, holds } = same[0] as ChannelLimit, limit = figure(value, unit);
    const whose = channels.filter((channel) => same.some((one) => one.channel === channel)).map(wordsOf).join(", ");
    return { value, failed, holds, label: t("{what}: limit {limit}", { what: what || whose, limit }) };
  });
}

// Values that the range of an axis has to reach, so that what was failed is in sight: of the limits of a channel on
// both sides the one that is nearer to what was measured.
export function failedIn(limits: readonly ChannelLimit[], channels: readonly string[], shown: Range, low: number, high: number): number[] {
  const nearest = new Map<string, number>(), off = (value: number) => Math.max(0, value - high, low - value);
  for (const { channel, value, what, failed, holds } of limits) {
    if (!failed || !channels.includes(channel) || (holds && (holds.from > shown.to || holds.to < shown.from))) continue;
    const key = `${channel} ${what}`, other = nearest.get(key);
    if (other === undefined || off(value) < off(other)) nearest.set(key, value);
  }
  return [...nearest.values()];
}
