// Says of a text that is typed that it has more letters than are kept: it is never cut off without a word.

import type { JSX } from "preact";
import { t } from "../i18n/text.ts";

// As the service counts them.
const lettersOf = (text: string): number => [...text.normalize("NFC")].length;

export const isTooLong = (text: string, most: number): boolean => lettersOf(text) > most;

export function TooLong({ text, most }: { text: string; most: number }): JSX.Element | null {
  return isTooLong(text, most) ? <p class="bad" role="alert">{t("It has {count} letters; at most {most} are kept. Shorten it.", { count: lettersOf(text), most })}</p> : null;
}
