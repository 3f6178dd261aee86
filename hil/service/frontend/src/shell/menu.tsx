// Links to all lists: in lines where there is room for them, else folded behind a button that says where one is.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { to, type Place } from "../addresses.ts";
import { t } from "../i18n/text.ts";
import { MENU } from "./commands.ts";

const LIST_OF: Record<string, string> = {
  bench: "benches", panel: "benches", run: "runs", plan: "plans", model: "models", controller: "controllers", "bench-file": "benches", "bench-files": "benches", recording: "recordings",
  identification: "identifications", diagnosis: "diagnoses", tuning: "tunings", campaign: "campaigns",
};

export function Menu({ place }: { place: Place }): JSX.Element {
  const list = LIST_OF[place.view] ?? place.view, [open, setOpen] = useState(false);
  const here = MENU.find(([view]) => view === list)?.[1];
  useEffect(() => setOpen(false), [place]);
  return (
    <nav class={open ? "menu open" : "menu"} aria-label={t("Pages")}>
      <button type="button" class="fold" aria-expanded={open} onClick={() => setOpen(!open)}>{here ? t("Pages: {page}", { page: here }) : t("Pages")}</button>
      <div class="entries">{MENU.map(([view, name]) => <a key={view} href={to.list(view)} aria-current={view === list ? "page" : undefined}>{name}</a>)}</div>
    </nav>
  );
}
