// Sentences that the service says, known by their form: the English sentence with its names and figures in braces is both
// the form and the key of its translation.

import { figuresIn, wordsOf as wordsOfChannel } from "../format.ts";
import { kindInWords } from "../ui/kinds.ts";
import { t } from "./text.ts";

export type Said = Record<string, string>;
export type Phrase = [RegExp, (of: Said) => string];
export type Words = (text: string) => string;

// What stands in these is a state, a role or a kind of thing.
const KINDS = ["kind", "state", "role"];

const inWords = (of: Said): Said => Object.fromEntries(Object.entries(of).map(([name, value]) => [name, KINDS.includes(name) ? kindInWords(value) : value]));

// A name or a figure ends where another sentence begins; these stand for sentences, which may be several.
const SENTENCES = ["reason", "why", "what", "doing", "reached", "speed", "states", "words", "software", "question", "answer", "text", "disk", "values", "command", "hazard"];

const valueOf = (name: string): string => `(?<${name}>${SENTENCES.includes(name) ? "." : "(?:(?![:;] ).)"}+?)`;

const formOf = (text: string): RegExp =>
  new RegExp(`^${text.split(/(\{\w+\})/).map((piece) => (/^\{\w+\}$/.test(piece) ? valueOf(piece.slice(1, -1)) : piece.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"))).join("")}$`, "s");

// `npm run texts` finds these as it finds those of `t`.
export const said = (text: string): Phrase => [formOf(text), (of) => t(text, inWords(of))];

const withWords = ([form, make]: Phrase, names: string[], words: Words): Phrase => [form, (of) => make({ ...of, ...Object.fromEntries(names.filter((name) => of[name]).map((name) => [name, words(of[name] ?? "")])) })];

// A sentence about others: what stands in it is in the reader's words too, where it is known.
export const around = (phrase: Phrase, words: Words, ...inner: string[]): Phrase => withWords(phrase, inner, words);

export const ofChannel = (phrase: Phrase, ...names: string[]): Phrase => withWords(phrase, names, wordsOfChannel);

// Who asked: one who is not signed in is known by their address.
export function personIn(name = ""): string {
  const place = /^somebody at (\S+)$/.exec(name)?.[1];
  return place ? t("somebody at {place}", { place }) : name;
}

// What is a figure, with or without its unit; not a version, an address or a name.
const isFigure = (text: string): boolean => /^[-−±]?\d+\.\d+(?:e[-+]?\d+)?(?: [^\d\s]+){0,2}$/.test(text);

const withFigures = (of: Said): Said => Object.fromEntries(Object.entries(of).map(([name, value]) => [name, value !== undefined && isFigure(value) ? figuresIn(value) : value]));

// The words of the first form that fits; null if none does.
export function wordsOf(phrases: readonly Phrase[], text: string): string | null {
  for (const [form, words] of phrases) {
    const found = form.exec(text);
    if (found) return words(withFigures(found.groups ?? {}));
  }
  return null;
}
