// Links to all lists: in lines where there is room for them, else folded behind a button that says where one is.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { to, type Place } from "../addresses.ts";
import { t } from "../i18n/text.ts";
import { ASIDE, MENU } from "./commands.ts";

const LIST_OF: Record<string, string> = {
  bench: "benches", panel: "benches", run: "runs", plan: "plans", model: "models", controller: "controllers", "bench-file": "benches", "bench-files": "benches", recording: "recordings",
  identification: "identifications", diagnosis: "diagnoses", tuning: "tunings", campaign: "campaigns",
};

const listOf = (place: Place): string => LIST_OF[place.view] ?? place.view;

const linksTo = (lists: readonly (typeof MENU[number] | typeof ASIDE[number])[], list: string, kind = ""): JSX.Element[] =>
  lists.map(([view, name]) => <a key={view} class={kind} href={to.list(view)} aria-current={view === list ? "page" : undefined}>{name}</a>);

// What has no place in a line of lists.
export const Aside = ({ place }: { place: Place }): JSX.Element => <nav class="aside" aria-label={t("Service")}>{linksTo(ASIDE, listOf(place))}</nav>;

export function Menu({ place }: { place: Place }): JSX.Element {
  const list = listOf(place), [open, setOpen] = useState(false);
  const here = [...MENU, ...ASIDE].find(([view]) => view === list)?.[1];
  useEffect(() => setOpen(false), [place]);
  return (
    <nav class={open ? "menu open" : "menu"} aria-label={t("Pages")}>
      <button type="button" class="fold" aria-expanded={open} onClick={() => setOpen(!open)}>{here ? t("Pages: {page}", { page: here }) : t("Pages")}</button>
      <div class="entries">{linksTo(MENU, list)}{linksTo(ASIDE, list, "folded")}</div>
    </nav>
  );
}
