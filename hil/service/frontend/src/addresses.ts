// Every view has an address: what it says, and how it is written.

import { t } from "./i18n/text.ts";

export type Place =
  | { view: "benches" | "runs" | "compare" | "trends" | "plans" | "models" | "controllers" | "bench-files" | "design" | "recordings" | "identifications" | "diagnoses" | "tunings" | "campaigns" | "audit" | "settings" | "glossary" }
  | { view: "bench" | "panel"; bench: string }
  | { view: "wall"; bench: string | null } // null: all benches
  | { view: "run"; run: number }
  | { view: "plan" | "model" | "controller" | "bench-file"; name: string }
  | { view: "recording" | "identification" | "diagnosis" | "tuning" | "campaign"; id: number }
  | { view: "missing"; path: string };

const LISTS = ["benches", "runs", "compare", "trends", "plans", "models", "controllers", "bench-files", "design", "recordings", "identifications", "diagnoses", "tunings", "campaigns", "audit", "settings", "glossary"] as const;
const NAMED = { plans: "plan", models: "model", controllers: "controller", "bench-files": "bench-file" } as const;
const NUMBERED = { recordings: "recording", identifications: "identification", diagnoses: "diagnosis", tunings: "tuning", campaigns: "campaign" } as const;

export function placeOf(path: string): Place {
  const missing: Place = { view: "missing", path };
  const [head = "", name, more, ...rest] = partsOf(path);
  if (rest.length) return missing;
  if (head === "") return { view: "benches" };
  if (head === "wall") return more === undefined ? { view: "wall", bench: name ?? null } : missing;
  const list = LISTS.find((one) => one === head);
  if (list === undefined) return missing;
  if (name === undefined) return { view: list };
  if (list === "benches") return more === undefined ? { view: "bench", bench: name } : more === "panel" ? { view: "panel", bench: name } : missing;
  if (more !== undefined) return missing;
  if (list in NAMED) return { view: NAMED[list as keyof typeof NAMED], name };
  const id = numberOf(name);
  if (id === null) return missing;
  if (list === "runs") return { view: "run", run: id };
  return list in NUMBERED ? { view: NUMBERED[list as keyof typeof NUMBERED], id } : missing;
}

function partsOf(path: string): string[] {
  try {
    return path.split("/").filter(Boolean).map(decodeURIComponent);
  } catch { // not an encoding
    return ["?"];
  }
}

function numberOf(text: string): number | null {
  return /^[1-9][0-9]{0,9}$/.test(text) ? Number(text) : null;
}

// The former page had one address, with a bench behind it: /#sim.
export function placeOfFormer(path: string, hash: string): string | null {
  if (path !== "/" || hash.length < 2) return null;
  try {
    return to.bench(decodeURIComponent(hash.slice(1)));
  } catch { // not an encoding
    return null;
  }
}

const name = encodeURIComponent;

export const to = {
  list: (view: (typeof LISTS)[number]): string => `/${view}`,
  bench: (bench: string): string => `/benches/${name(bench)}`,
  panel: (bench: string): string => `/benches/${name(bench)}/panel`,
  wall: (bench?: string): string => (bench === undefined ? "/wall" : `/wall/${name(bench)}`),
  run: (run: number): string => `/runs/${run}`,
  plan: (plan: string): string => `/plans/${name(plan)}`,
  model: (model: string): string => `/models/${name(model)}`,
  controller: (controller: string): string => `/controllers/${name(controller)}`,
  benchFile: (file: string): string => `/bench-files/${name(file)}`,
  recording: (id: number): string => `/recordings/${id}`,
  identification: (id: number): string => `/identifications/${id}`,
  diagnosis: (id: number): string => `/diagnoses/${id}`,
  tuning: (id: number): string => `/tunings/${id}`,
  campaign: (id: number): string => `/campaigns/${id}`,
  compare: (first: number, other: number): string => `/compare?runs=${first},${other}`,
};

const TITLES: Record<(typeof LISTS)[number], string> = {
  benches: t("Benches"), runs: t("Runs"), compare: t("Compare runs"), trends: t("Trends"), plans: t("Plans"), models: t("Models"), controllers: t("Controllers"), "bench-files": t("Bench files"),
  design: t("Design a controller"), recordings: t("Recordings"), identifications: t("Identifications"), diagnoses: t("Diagnoses"), tunings: t("Tune a controller"), campaigns: t("Campaigns"), audit: t("Audit log"), settings: t("Settings"), glossary: t("Words of this page"),
};

export function titleOf(place: Place): string {
  switch (place.view) {
    case "bench": return t("Bench {bench}", { bench: place.bench });
    case "panel": return t("Operator panel of {bench}", { bench: place.bench });
    case "wall": return place.bench === null ? t("All benches") : t("Bench {bench}", { bench: place.bench });
    case "run": return t("Run {run}", { run: place.run });
    case "plan": return t("Plan {name}", { name: place.name });
    case "model": return t("Model {name}", { name: place.name });
    case "controller": return t("Controller {name}", { name: place.name });
    case "bench-file": return t("Bench file {name}", { name: place.name });
    case "recording": return t("Recording {number}", { number: place.id });
    case "identification": return t("Identification {number}", { number: place.id });
    case "diagnosis": return t("Diagnosis {number}", { number: place.id });
    case "tuning": return t("Tuning {number}", { number: place.id });
    case "campaign": return t("Campaign {number}", { number: place.id });
    case "missing": return t("No such page");
    default: return TITLES[place.view];
  }
}
