// Texts with a limit: one that is too long stays as it was typed or pasted, the limit is said, and it is not sent.

import type { JSX } from "preact";
import { t } from "../i18n/text.ts";

// Of the names of plans, models, controllers and bench files.
export const LONGEST_FILE_NAME = 64;
// Of the texts of files.
export const LONGEST_FILE = 200_000;

// As the service counts them.
const lettersOf = (text: string): number => [...text.normalize("NFC")].length;

const MOST_BY_COMPOSING = 3; // what one unit becomes in that form; so long texts are seldom counted

export const isTooLong = (text: string, most: number): boolean => text.length * MOST_BY_COMPOSING > most && lettersOf(text) > most;

export const tooLongText = (text: string, most: number): string => (isTooLong(text, most) ? t("It has {count} letters; at most {most} are kept. Shorten it.", { count: lettersOf(text), most }) : "");

export function TooLong({ text, most }: { text: string; most: number }): JSX.Element | null {
  const refused = tooLongText(text, most);
  return refused ? <p class="bad" role="alert">{refused}</p> : null;
}

// For `ref`: the browser sends no form with a text that is too long. Its own `maxlength` would cut what is pasted.
export const refuseTooLong = (text: string, most: number) => (field: HTMLInputElement | HTMLTextAreaElement | null): void => field?.setCustomValidity(tooLongText(text, most));

interface Options {
  label: string;
  most: number;
  value: string;
  onText: (text: string) => void;
  search?: boolean;
  required?: boolean;
  pattern?: string;
  title?: string;
  placeholder?: string;
  autocomplete?: "off" | "name";
}

export function LimitedField({ label, most, value, onText, search = false, autocomplete = "off", ...more }: Options): JSX.Element {
  const field = { ...more, autocomplete, value, ref: refuseTooLong(value, most), "aria-invalid": isTooLong(value, most), onInput: (event: { currentTarget: HTMLInputElement }) => onText(event.currentTarget.value) };
  return (
    <>
      <label class="field">{label}{search ? <input type="search" {...field} /> : <input {...field} />}</label>
      <TooLong text={value} most={most} />
    </>
  );
}
