// Numbers and names of a diagnosis in words.

import { significant } from "../../format.ts";
import { t } from "../../i18n/text.ts";

export { significant };

export const percentOf = (share: number): string => `${significant(100 * share, 3)} %`;

// The name that a plan says of itself; the service files it under this.
export function planNameOf(text: string): string {
  const found = /^name:\s*["']?([A-Za-z0-9_.-]+)/m.exec(text)?.[1];
  if (!found) throw new Error(t("The plan of this test says no name."));
  return found;
}

// How strongly a cell is coloured, in per cent: with the logarithm of error over noise, from 1 to 100.
export const heatOf = (error: number | null): number => (error === null || error <= 1 ? 0 : Math.round(35 * Math.min(1, Math.log10(error) / 2)));

type Table = readonly (readonly (readonly (number | null)[])[])[];

// The worst recording of a channel and a band; null where none has a value.
export function worstOf(table: Table, channel: number, band: number): number | null {
  const values = table.map((recording) => recording[channel]?.[band]).filter((one): one is number => one !== null && one !== undefined);
  return values.length ? Math.max(...values) : null;
}
