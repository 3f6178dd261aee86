// Numbers as people type them: a decimal comma is a decimal point, and what may mean two numbers is refused.

import { LANGUAGE } from "../i18n/language.ts";
import { t } from "../i18n/text.ts";

const NUMBER = /^([-+]?)(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
// "1,200" is 1200 to some readers and 1.2 to others, "1.200" to others still: by the page's language.
const MAY_GROUP = { ",": /^[-+]?[1-9]\d{0,2},\d{3}$/, ".": /^[-+]?[1-9]\d{0,2}\.\d{3}$/ };
type Groups = keyof typeof MAY_GROUP;
export const POINTED = "en"; // what a field was given: always with a decimal point

export interface Bounds {
  min?: number | undefined;
  max?: number | undefined;
  whole?: boolean;
  required?: boolean;
}

const groupMark = (language: string): Groups => (new Intl.NumberFormat(language).formatToParts(1234567).some(({ type, value }) => type === "group" && value === ".") ? "." : ",");

// As it is written with a decimal point; null for no number, and for one that may be another.
export function pointed(typed: string, language: string = LANGUAGE): string | null {
  const text = typed.normalize("NFKC").trim().replace(/[−–]/g, "-");
  if (MAY_GROUP[groupMark(language)].test(text)) return null;
  const [, sign = "", digits = "", power = ""] = NUMBER.exec(text.replace(/^([-+]?\d*),(\d*)/, "$1.$2")) ?? [];
  if (!digits || !Number.isFinite(Number(digits + power))) return null;
  return (sign === "-" ? "-" : "") + digits.replace(/^\./, "0.").replace(/\.$/, "") + power;
}

export const numberIn = (typed: string): number => { const text = pointed(typed); return text === null ? NaN : Number(text); };

const LONGEST_SHOWN = 40, KEPT = 16;

// What somebody typed, in a message: of a very long text its two ends.
const shown = (text: string): string => (text.length > LONGEST_SHOWN ? `${text.slice(0, KEPT)}…${text.slice(-KEPT)}` : text);

// Why a field's text is not taken; '' if it is.
export function whyNoNumber(typed: string, { min, max, whole = false, required = false }: Bounds, language: string = LANGUAGE): string {
  if (typed.trim() === "") return required ? t("It is empty: write a number.") : "";
  const text = pointed(typed, language), mark = groupMark(language), bare = typed.trim();
  if (text === null) return MAY_GROUP[mark].test(bare) ? t("\"{typed}\" may be two numbers: write {point} or {plain}.", { typed: shown(typed), point: bare.replace(mark, mark === "," ? "." : ","), plain: bare.replace(mark, "") }) : t("\"{typed}\" is no number: write it as 20.5, without other signs.", { typed: shown(typed) });
  const value = Number(text), said = shown(text);
  if (whole && !Number.isInteger(value)) return t("{value} is no whole number.", { value: said });
  if ((min === undefined || value >= min) && (max === undefined || value <= max)) return "";
  if (min === undefined) return t("{value} is beyond its bound: at most {max}.", { value: said, max: max ?? "" });
  return max === undefined ? t("{value} is beyond its bound: at least {min}.", { value: said, min }) : t("{value} is beyond its bounds: {min} to {max}.", { value: said, min, max });
}
