// Every view has an address: what it says, and how it is written.

export type Place =
  | { view: "benches" | "runs" | "compare" | "trends" | "plans" | "models" | "controllers" | "bench-files" | "design" | "recordings" | "identifications" | "diagnoses" | "campaigns" | "audit" | "settings" }
  | { view: "bench" | "panel"; bench: string }
  | { view: "run"; run: number }
  | { view: "plan" | "model" | "controller" | "bench-file"; name: string }
  | { view: "recording" | "identification" | "diagnosis" | "campaign"; id: number }
  | { view: "missing"; path: string };

const LISTS = ["benches", "runs", "compare", "trends", "plans", "models", "controllers", "bench-files", "design", "recordings", "identifications", "diagnoses", "campaigns", "audit", "settings"] as const;
const NAMED = { plans: "plan", models: "model", controllers: "controller", "bench-files": "bench-file" } as const;
const NUMBERED = { recordings: "recording", identifications: "identification", diagnoses: "diagnosis", campaigns: "campaign" } as const;

export function placeOf(path: string): Place {
  const missing: Place = { view: "missing", path };
  const [head = "", name, more, ...rest] = partsOf(path);
  if (rest.length) return missing;
  if (head === "") return { view: "benches" };
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
  run: (run: number): string => `/runs/${run}`,
  plan: (plan: string): string => `/plans/${name(plan)}`,
  model: (model: string): string => `/models/${name(model)}`,
  controller: (controller: string): string => `/controllers/${name(controller)}`,
  benchFile: (file: string): string => `/bench-files/${name(file)}`,
  recording: (id: number): string => `/recordings/${id}`,
  identification: (id: number): string => `/identifications/${id}`,
  diagnosis: (id: number): string => `/diagnoses/${id}`,
  campaign: (id: number): string => `/campaigns/${id}`,
  compare: (first: number, other: number): string => `/compare?runs=${first},${other}`,
};

const TITLES: Record<(typeof LISTS)[number], string> = {
  benches: "Benches", runs: "Runs", compare: "Compare runs", trends: "Trends", plans: "Plans", models: "Models", controllers: "Controllers", "bench-files": "Bench files",
  design: "Design a controller", recordings: "Recordings", identifications: "Identifications", diagnoses: "Diagnoses", campaigns: "Campaigns", audit: "Audit log", settings: "Settings",
};

export function titleOf(place: Place): string {
  switch (place.view) {
    case "bench": return `Bench ${place.bench}`;
    case "panel": return `Operator panel of ${place.bench}`;
    case "run": return `Run ${place.run}`;
    case "plan": return `Plan ${place.name}`;
    case "model": return `Model ${place.name}`;
    case "controller": return `Controller ${place.name}`;
    case "recording": return `Recording ${place.id}`;
    case "identification": return `Identification ${place.id}`;
    case "diagnosis": return `Diagnosis ${place.id}`;
    case "bench-file": return `Bench file ${place.name}`;
    case "campaign": return `Campaign ${place.id}`;
    case "missing": return "No such page";
    default: return TITLES[place.view];
  }
}
