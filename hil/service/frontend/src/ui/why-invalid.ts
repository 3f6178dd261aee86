// Why a form is not sent, said of the first field that keeps it back: the browser says it in its own language.

import { dayText, moment } from "../format.ts";
import { t } from "../i18n/text.ts";

export interface Field {
  validity: ValidityState;
  validationMessage: string;
  tagName: string;
  type: string;
  title: string;
  min?: string;
  max?: string;
  placeholder?: string;
}

export function whyInvalid({ validity, validationMessage, tagName, type, title, min = "", max = "", placeholder = "" }: Field): string {
  if (validity.customError) return validationMessage; // the page's own
  if (validity.badInput) return type === "date" ? t("This is no complete date.") : t("This is no complete date with a time.");
  if (validity.valueMissing) return tagName === "SELECT" ? t("Choose one of the list.") : type === "file" ? t("Choose a file.") : t("This field is empty.");
  if (validity.patternMismatch) return title ? t("Allowed are {what}, and first a letter or a digit.", { what: title }) : placeholder ? t("It must be written like {example}.", { example: placeholder }) : t("This is not written as it must be.");
  if (validity.rangeUnderflow) return t("The earliest is {moment}.", { moment: bound(type, min) });
  if (validity.rangeOverflow) return t("The latest is {moment}.", { moment: bound(type, max) });
  return t("This is not written as it must be.");
}

const bound = (type: string, value: string): string => (type === "date" ? dayText(value) : moment(value));
