// Where the name in an address is nobody's: that there is none, and the way to those that there are.

import type { ComponentChildren, JSX } from "preact";
import { to } from "../addresses.ts";
import { t } from "../i18n/text.ts";
import { Heading } from "../ui/parts.tsx";

export type NamedKind = "plan" | "model" | "controller" | "bench" | "bench-file";

const LISTS = { plan: "plans", model: "models", controller: "controllers", bench: "benches", "bench-file": "bench-files" } as const;

export function NoneThere({ kind, name, children }: { kind: NamedKind; name: string; children?: ComponentChildren }): JSX.Element {
  const [none, all] = {
    plan: [t("There is no plan '{name}'", { name }), t("All plans")], model: [t("There is no model '{name}'", { name }), t("All models")],
    controller: [t("There is no controller '{name}'", { name }), t("All controllers")], bench: [t("There is no bench '{bench}'", { bench: name }), t("All benches")],
    "bench-file": [t("There is no bench file '{name}'", { name }), t("All bench files")],
  }[kind];
  return (
    <>
      <Heading>{none}</Heading>
      <p>{t("It may be misspelled in the address, or was removed.")} <a href={to.list(LISTS[kind])}>{all}</a></p>
      {children}
    </>
  );
}
