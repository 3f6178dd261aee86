// Light or dark as the system has it, unless somebody chose otherwise in this browser.

import { t } from "./i18n/text.ts";
import { Store } from "./store.ts";

export type Theme = "system" | "light" | "dark";
export const THEMES: Theme[] = ["system", "light", "dark"];
export const THEME_NAMES: Record<Theme, string> = { system: t("as the system"), light: t("light"), dark: t("dark") };
const KEY = "theme";

// Counts up whenever colours have changed: what is drawn on a canvas is drawn again.
export const coloured = new Store(0);
export const theme = new Store<Theme>(kept());

function kept(): Theme {
  const found = localStorage.getItem(KEY);
  return THEMES.find((one) => one === found) ?? "system";
}

export function chooseTheme(chosen: Theme): void {
  localStorage.setItem(KEY, chosen);
  theme.value = chosen;
  show();
}

function show(): void {
  if (theme.value === "system") delete document.documentElement.dataset["theme"];
  else document.documentElement.dataset["theme"] = theme.value;
  coloured.value += 1;
}

export function beginTheme(): void {
  show();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { coloured.value += 1; });
}

// A plot asks for some in each frame: they are looked up once, until they change.
const colours = new Map<string, string>();
coloured.subscribe(() => colours.clear());

export function colour(name: string): string {
  const known = colours.get(name);
  if (known) return known;
  const found = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  colours.set(name, found);
  return found;
}

// A view that is always light or always dark; what is returned gives the colours of this browser back.
export function showAs(shown: Exclude<Theme, "system">): () => void {
  document.documentElement.dataset["theme"] = shown;
  coloured.value += 1;
  return show;
}
