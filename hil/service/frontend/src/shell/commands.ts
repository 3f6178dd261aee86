// Commands of the palette, and the addresses of the menu.

import { to } from "../addresses.ts";
import { chooseLanguage, LANGUAGES, type Language } from "../i18n/language.ts";
import { t } from "../i18n/text.ts";
import { chooseTheme, THEME_NAMES, THEMES } from "../theme.ts";
import type { Entry } from "./matching.ts";
import { pressStop, stopScope } from "./stop.tsx";
import { signOut } from "./sign-in.tsx";

export const MENU = [
  ["benches", t("Benches"), "Benches"], ["runs", t("Runs"), "Runs"], ["compare", t("Compare"), "Compare"], ["trends", t("Trends"), "Trends"], ["plans", t("Plans"), "Plans"], ["models", t("Models"), "Models"],
  ["controllers", t("Controllers"), "Controllers"], ["design", t("Design"), "Design"], ["recordings", t("Recordings"), "Recordings"], ["identifications", t("Identify"), "Identify"], ["diagnoses", t("Diagnose"), "Diagnose"], ["tunings", t("Tune"), "Tune"], ["campaigns", t("Campaigns"), "Campaigns"],
] as const;
// In the bar above it, where there is room; in the menu where that is folded.
export const ASIDE = [["audit", t("Audit"), "Audit"], ["settings", t("Settings"), "Settings"]] as const;
const MORE = [["bench-files", t("Bench files"), "Bench files"], ["glossary", t("Words of this page"), "Words of this page glossary help"]] as const; // beside the menu, which is full

// `bench`: of the emergency stop, '' for all. Whoever cannot read the page's language finds their own here by its name.
export const commands = (bench: string): Entry[] => [
  ...[...MENU, ...ASIDE, ...MORE].map(([view, name, also]) => ({ kind: t("page"), name, about: "", path: to.list(view), also: `page ${also}` })),
  { kind: t("page"), name: t("For the wall of a control room"), about: "", path: to.wall(), also: "page wall" },
  ...THEMES.map((theme) => ({ kind: t("command"), name: t("Colours: {theme}", { theme: THEME_NAMES[theme] }), about: t("light or dark"), act: () => chooseTheme(theme), also: `command Colours: ${theme}` })),
  ...Object.entries(LANGUAGES).map(([tag, name]) => ({ kind: t("command"), name: t("Language: {language}", { language: name }), about: "", act: () => chooseLanguage(tag as Language), also: `command Language: ${tag}` })),
  { kind: t("command"), name: t("Emergency stop"), about: stopScope(bench), act: () => void pressStop(bench), also: "command Emergency stop", byName: `${t("Emergency stop")} Emergency stop` },
  { kind: t("command"), name: t("Sign out"), about: "", act: () => void signOut(), also: "command Sign out" },
];
