// The name of a file of the service: letters, digits, _ and -.

import type { JSX } from "preact";
import { t } from "../i18n/text.ts";

interface Options {
  value: string;
  onChange: (name: string) => void;
  label?: string;
  optional?: boolean;
  placeholder?: string;
}

export function NameField({ value, onChange, label = t("Name"), optional = false, placeholder = "" }: Options): JSX.Element {
  return (
    <label class="field">{label}
      <input required={!optional} maxLength={64} pattern="[A-Za-z0-9][A-Za-z0-9_\-]*" title={t("letters, digits, _ and -")} autocomplete="off" placeholder={placeholder} value={value} onInput={(event) => onChange(event.currentTarget.value)} />
    </label>
  );
}
