// Texts in the reader's language. The English text is the key; a catalogue gives the others.

import type { ComponentChildren } from "preact";
import { CATALOGUE, LANGUAGE, LOCALE, type Catalogue } from "./language.ts";

export type Values = Record<string, string | number>;
export type Shown = Record<string, ComponentChildren | ((words: ComponentChildren) => ComponentChildren)>;

const NOTHING = "–"; // what the service did not say

const filled = (text: string, values: Values): string =>
  text.replace(/\{(\w+)\}/g, (whole, name: string) => (name in values ? String(values[name] ?? NOTHING) : whole));

const found = (text: string): string => {
  const known = CATALOGUE[text];
  return typeof known === "string" ? known : text;
};

// A whole sentence or name, never a piece of one: word order differs between languages. Values stand in braces.
export const t = (text: string, values: Values = {}): string => filled(found(text), values);

// With a number that decides the word's form; the key is the second text. `{count}` stands for the number.
export const tn = (one: string, others: string, count: number, values: Values = {}): string => {
  const whole = new Intl.NumberFormat(LOCALE).format(count);
  return filled(pluralOf(CATALOGUE, LANGUAGE, one, others, count), { count: whole, ...values });
};

export function pluralOf(catalogue: Catalogue, language: string, one: string, others: string, count: number): string {
  const known = catalogue[others];
  if (typeof known === "object") return known[new Intl.PluralRules(language).select(count)] ?? known["other"] ?? others;
  return new Intl.PluralRules("en").select(count) === "one" ? one : others;
}

// With elements in it: `{name}` is one as it is, `<name>words</name>` one that is made around the words.
export const tx = (text: string, shown: Shown): ComponentChildren[] => pieces(found(text), shown);

export function pieces(text: string, shown: Shown): ComponentChildren[] {
  return text.split(/(\{\w+\}|<\w+>.*?<\/\w+>)/).filter(Boolean).map((piece) => {
    const [, whole = "", around = "", words = ""] = /^\{(\w+)\}$|^<(\w+)>(.*?)<\/\w+>$/.exec(piece) ?? [];
    const element = shown[whole || around];
    if (typeof element === "function") return element(/\{/.test(words) ? pieces(words, shown) : words);
    return (whole || around) in shown ? element ?? NOTHING : piece;
  });
}
