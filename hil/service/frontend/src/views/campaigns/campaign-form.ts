// A campaign's file from what was chosen in its form, which is made from the file's JSON schema.

import { t } from "../../i18n/text.ts";
import { POINTED, whyNoNumber } from "../../ui/typed-numbers.ts";

export interface Property {
  type?: string | string[];
  description?: string;
  default?: unknown;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
  anyOf?: Property[];
  properties?: Record<string, Property>;
}

export interface Varied {
  name: string;
  from: string;
  to: string;
  count: string;
}

export interface Chosen {
  plain: Record<string, string>; // texts and numbers by key, '' for the default
  lists: Record<string, string[]>;
  tolerance: Record<string, string>; // 'true' of those that are on or off
  vary: Varied[];
}

export const COUNT = { min: 2, max: 100_000, whole: true }; // values of one that is varied

export const NOTHING: Chosen = { plain: {}, lists: {}, tolerance: {}, vary: [] };

export const isNumber = ({ type, anyOf }: Property): boolean => [type].flat().some((one) => one === "number" || one === "integer") || (anyOf ?? []).some(isNumber);

// Keys of plain texts and numbers, as the schema has them; others have controls of their own.
export const plainKeys = (schema: Property): string[] =>
  Object.entries(schema.properties ?? {}).filter(([name, one]) => name !== "format" && !["array", "object"].includes(String([one.type].flat()[0]))).map(([name]) => name);

const isWhole = ({ type }: Property): boolean => [type].flat().includes("integer");

export const boundsOf = (property: Property): { min?: number; max?: number; whole: boolean } => {
  const of = property.anyOf?.find(isNumber) ?? property, least = of.minimum ?? of.exclusiveMinimum, most = of.maximum ?? of.exclusiveMaximum;
  return { ...(least === undefined ? {} : { min: least }), ...(most === undefined ? {} : { max: most }), whole: isWhole(of) };
};

export const NAME = "[A-Za-z0-9][A-Za-z0-9_.\\-]*", VARIED = "(controller|model|plan)\\.[^.]+|effect\\.[^.]+\\.[^.]+";
const isLike = (pattern: string, text: string): boolean => text === "" || new RegExp(`^(?:${pattern})$`).test(text);

const LONGEST_NAME = 64;

// Why a name is not taken; '' if it is, and while there is none.
export function whyNoName(name: string): string {
  if (!isLike(NAME, name)) return t("Allowed are {what}, and first a letter or a digit.", { what: t("letters, digits, _ . and -") });
  return name.length > LONGEST_NAME ? t("It has {count} letters; at most {most} are kept. Shorten it.", { count: name.length, most: LONGEST_NAME }) : "";
}

export const whyNotVaried = (name: string): string => (isLike(VARIED, name) ? "" : t("It must be written like {example}.", { example: "model.vehicle_inertia" }));

// Whether a field has what is not taken; empty ones are asked for when the form is sent.
export function isWrong(schema: Property, { plain, tolerance, vary }: Chosen): boolean {
  const isBad = (properties: Record<string, Property> | undefined, texts: Record<string, string>): boolean =>
    Object.entries(properties ?? {}).some(([name, one]) => isNumber(one) && whyNoNumber(texts[name] ?? "", boundsOf(one), POINTED) !== "");
  return isBad(schema.properties, plain) || isBad(schema.properties?.["tolerance"]?.properties, tolerance) || whyNoName(plain["name"] ?? "") !== ""
    || vary.some((one) => whyNotVaried(one.name) !== "" || [one.from, one.to].some((text) => whyNoNumber(text, {}, POINTED)) || whyNoNumber(one.count, COUNT, POINTED) !== "");
}

// YAML as the service reads it: texts as JSON has them, which YAML reads, too.
export function campaignText(schema: Property, chosen: Chosen): string {
  const lines = ["format: 1"];
  for (const name of plainKeys(schema)) {
    const text = (chosen.plain[name] ?? "").trim();
    if (text !== "") lines.push(`${name}: ${isNumber(schema.properties?.[name] ?? {}) ? Number(text) : plainText(text)}`);
  }
  for (const [name, all] of Object.entries(chosen.lists)) if (all.length) lines.push(`${name}: [${all.map(plainText).join(", ")}]`);
  const varied = chosen.vary.filter((one) => one.name.trim() && one.from !== "");
  if (varied.length) lines.push("vary:", ...varied.map((one) => `  ${one.name.trim()}: ${spanText(one)}`));
  const tolerance = Object.entries(chosen.tolerance).filter(([, text]) => text !== "" && text !== "false");
  if (tolerance.length) lines.push("tolerance:", ...tolerance.map(([name, text]) => `  ${name}: ${text === "true" ? text : Number(text)}`));
  return `${lines.join("\n")}\n`;
}

const plainText = (text: string): string => (/^[A-Za-z][A-Za-z0-9_.-]*$/.test(text) && !/^(true|false|yes|no|on|off|null)$/i.test(text) ? text : JSON.stringify(text));

const spanText = ({ from, to, count }: Varied): string => (to === "" ? `[${Number(from)}]` : `{from: ${Number(from)}, to: ${Number(to)}, count: ${Math.max(2, Number(count) || 2)}}`);
