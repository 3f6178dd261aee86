// Where the name or the number in an address is nobody's: that there is none, and the way to those that there are.

import type { ComponentChildren, JSX } from "preact";
import { to } from "../addresses.ts";
import { t } from "../i18n/text.ts";
import { Heading } from "../ui/parts.tsx";

const LISTS = {
  plan: "plans", model: "models", controller: "controllers", bench: "benches", "bench-file": "bench-files",
  run: "runs", recording: "recordings", identification: "identifications", diagnosis: "diagnoses", tuning: "tunings", campaign: "campaigns",
} as const;

export type MissingKind = keyof typeof LISTS;

// `name`: or its number.
export function NoneThere({ kind, name, children }: { kind: MissingKind; name: string | number; children?: ComponentChildren }): JSX.Element {
  const [none, all] = {
    plan: [t("There is no plan '{name}'", { name }), t("All plans")], model: [t("There is no model '{name}'", { name }), t("All models")],
    controller: [t("There is no controller '{name}'", { name }), t("All controllers")], bench: [t("There is no bench '{bench}'", { bench: name }), t("All benches")],
    "bench-file": [t("There is no bench file '{name}'", { name }), t("All bench files")], run: [t("There is no run {run}", { run: name }), t("All runs")],
    recording: [t("There is no recording {number}", { number: name }), t("All recordings")], identification: [t("There is no identification {number}", { number: name }), t("All identifications")],
    diagnosis: [t("There is no diagnosis {number}", { number: name }), t("All diagnoses")], tuning: [t("There is no tuning {number}", { number: name }), t("All tunings")],
    campaign: [t("There is no campaign {number}", { number: name }), t("All campaigns")],
  }[kind];
  return (
    <>
      <Heading>{none}</Heading>
      <p>{t("It may be misspelled in the address, or was removed.")} <a href={to.list(LISTS[kind])}>{all}</a></p>
      {children}
    </>
  );
}
