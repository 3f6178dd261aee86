// Commands of the palette, and the addresses of the menu.

import { to } from "../addresses.ts";
import { chooseTheme, THEMES } from "../theme.ts";
import type { Entry } from "./matching.ts";
import { benchInSight } from "./stop.tsx";
import { attempt } from "../data.ts";
import { stopNow } from "../api/client.ts";
import { signOut } from "./sign-in.tsx";

export const MENU = [
  ["benches", "Benches"], ["runs", "Runs"], ["compare", "Compare"], ["trends", "Trends"], ["plans", "Plans"], ["models", "Models"],
  ["controllers", "Controllers"], ["design", "Design"], ["recordings", "Recordings"], ["identifications", "Identify"], ["diagnoses", "Diagnose"], ["campaigns", "Campaigns"], ["audit", "Audit"], ["settings", "Settings"],
] as const;
const MORE = [["bench-files", "Bench files"]] as const; // beside the menu, which is full

export const commands = (): Entry[] => [
  ...[...MENU, ...MORE].map(([view, name]) => ({ kind: "page", name, about: "", path: to.list(view) })),
  ...THEMES.map((theme) => ({ kind: "command", name: `Colours: ${theme}`, about: "light or dark", act: () => chooseTheme(theme) })),
  { kind: "command", name: "Emergency stop", about: benchInSight.value || "all benches", act: () => void attempt(() => stopNow(benchInSight.value)) },
  { kind: "command", name: "Sign out", about: "", act: () => void signOut() },
];
