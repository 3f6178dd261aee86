// The name of a file of the service: letters, digits, _ and -.

import type { JSX } from "preact";
import { t } from "../i18n/text.ts";
import { LimitedField, LONGEST_FILE_NAME } from "./too-long.tsx";

interface Options {
  value: string;
  onChange: (name: string) => void;
  label?: string;
  optional?: boolean;
  placeholder?: string;
}

export function NameField({ value, onChange, label = t("Name"), optional = false, placeholder = "" }: Options): JSX.Element {
  return (
    <LimitedField label={label} most={LONGEST_FILE_NAME} required={!optional} pattern="[A-Za-z0-9][A-Za-z0-9_\-]*" title={t("letters, digits, _ and -")} placeholder={placeholder} value={value} onText={onChange} />
  );
}
