// Values of a plan's variables as they are typed: what they are, and which is not taken.

import type { Plan } from "../../api/types.ts";
import { t } from "../../i18n/text.ts";
import { POINTED, numberIn, pointed, whyNoNumber, type Bounds } from "../../ui/typed-numbers.ts";

export type Variable = Plan["variables"][string];

export type Texts = Record<string, string>; // as they are typed, by the names of variables

export const valuesOf = (plan: Plan | null | undefined, texts: Texts): Record<string, number> =>
  Object.fromEntries(Object.entries(plan?.variables ?? {}).map(([name, { default: usual }]) => [name, texts[name] === undefined ? usual : numberIn(texts[name])]));

export const labelOf = (name: string, { description, unit }: Variable): string => (unit ? t("{name} in {unit}", { name: description || name, unit }) : description || name);

export const boundsOf = ({ lower, upper }: Variable): Bounds => ({ min: lower ?? undefined, max: upper ?? undefined, required: true });

// The first value that is not taken, and why; '' if all are.
export function wrongIn(plan: Plan | null | undefined, texts: Texts): string {
  for (const [name, variable] of Object.entries(plan?.variables ?? {})) {
    const why = whyNoNumber(texts[name] ?? String(variable.default), boundsOf(variable), POINTED);
    if (why) return `${labelOf(name, variable)}: ${why}`;
  }
  return "";
}

// Whether the plan's own values stand.
export const areUsual = (plan: Plan, texts: Texts): boolean => Object.entries(valuesOf(plan, texts)).every(([name, value]) => value === plan.variables[name]?.default);

// Numbers that are not the plan's own, with decimal points: what somebody has changed.
export const changedIn = (plan: Plan, texts: Texts): Texts =>
  Object.fromEntries(Object.entries(plan.variables).flatMap(([name, { default: usual }]) => {
    const text = pointed(texts[name] ?? "");
    return text === null || Number(text) === usual ? [] : [[name, text]];
  }));
