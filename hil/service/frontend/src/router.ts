// The address that is shown: links change it without loading the page, back and forward work as anywhere.

import { useEffect, useMemo } from "preact/hooks";
import { placeOf, placeOfFormer, type Place } from "./addresses.ts";
import { API } from "./api/client.ts";
import { t } from "./i18n/text.ts";
import { agreedToLeave, isAllSaved } from "./leaving.ts";
import { Store, useStore } from "./store.ts";

const former = placeOfFormer(location.pathname, location.hash);
if (former) history.replaceState(null, "", former);

const here = (): string => location.pathname + location.search;
const address = new Store(here());

let leaving = false; // somebody has agreed to the step back that comes next

addEventListener("popstate", () => {
  if (leaving || isAllSaved()) {
    leaving = false;
    address.value = here();
    return;
  }
  history.pushState(null, "", address.value); // the view stays, and its address with it, until somebody agrees
  void agreedToLeave().then((agreed) => {
    if (!agreed) return;
    leaving = true;
    history.back();
  });
});

export function go(path: string, replace = false): void {
  if (path === here()) return;
  if (replace || isAllSaved()) show(path, replace);
  else void agreedToLeave().then((agreed) => { if (agreed) show(path, false); });
}

function show(path: string, replace: boolean): void {
  if (replace) history.replaceState(null, "", path); else history.pushState(null, "", path);
  address.value = here();
  if (!replace) scrollTo(0, 0);
}

export function usePlace(): Place {
  const path = useStore(address).split("?")[0] ?? "";
  return useMemo(() => placeOf(path), [path]);
}

// The query of the address; setting it keeps the view and adds no step to go back unless `step` says so.
export function useQuery(): [URLSearchParams, (query: URLSearchParams, step?: boolean) => void] {
  const search = useStore(address).split("?")[1] ?? "";
  const query = useMemo(() => new URLSearchParams(search), [search]);
  return [query, setQuery];
}

export function setQuery(query: URLSearchParams, step = false): void {
  const text = readable(query);
  go(location.pathname + (text ? `?${text}` : ""), !step);
}

// Commas, colons and semicolons may stand in a query as they are.
const readable = (query: URLSearchParams): string => query.toString().replaceAll("%2C", ",").replaceAll("%3A", ":").replaceAll("%3B", ";");

export function useTitle(title: string): void {
  useEffect(() => { document.title = `${title} – ${t("e-Axle bench service")}`; }, [title]);
}

// Links of the page itself are followed here; others, and those opened elsewhere, by the browser.
export function followLinks(): void {
  document.addEventListener("click", (event) => {
    if (event.defaultPrevented || event.button || event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
    const link = (event.target as Element).closest?.("a");
    if (!link || link.target || link.hasAttribute("download")) return;
    const url = new URL(link.href);
    if (url.origin !== location.origin || url.pathname.startsWith(API)) return;
    event.preventDefault();
    go(url.pathname + url.search);
  });
}
