// Drafts of controllers as they stand in the address of the design studio, and as the service is asked about them.

import { t } from "../../i18n/text.ts";

export type Kind = "phase" | "gain";

export const FIELDS = ["lead_deg", "lead_hz", "notch_hz", "notch_width", "notch_depth", "pole_rad_s"] as const;
export type Field = (typeof FIELDS)[number];

export interface Draft {
  kind: Kind;
  texts: Record<Field, string>; // as typed; '' leaves it to the service
}

interface Bounds {
  usual: string;
  least: number;
  most: number;
  slide: readonly [number, number, number]; // from, to, step
  of: Kind | "both";
}

// Defaults are the paper's, bounds those of `hil design`.
export const BOUNDS: Record<Field, Bounds> = {
  lead_deg: { usual: "36", least: 1, most: 85, slide: [1, 80, 0.5], of: "phase" },
  lead_hz: { usual: "40", least: 2, most: 499, slide: [2, 120, 0.5], of: "phase" },
  notch_hz: { usual: "", least: 0.1, most: 499, slide: [2, 60, 0.1], of: "gain" },
  notch_width: { usual: "2", least: 0.001, most: 100, slide: [0.05, 5, 0.05], of: "gain" },
  notch_depth: { usual: "0.08", least: 0, most: 1, slide: [0, 1, 0.01], of: "gain" },
  pole_rad_s: { usual: "0.3", least: 0.001, most: 100, slide: [0.05, 5, 0.05], of: "both" },
};

export const MOST_DRAFTS = 4;

export const fieldsOf = (kind: Kind): Field[] => FIELDS.filter((one) => BOUNDS[one].of === kind || BOUNDS[one].of === "both");

export const usualDraft = (kind: Kind): Draft => ({ kind, texts: Object.fromEntries(FIELDS.map((one) => [one, BOUNDS[one].usual])) as Record<Field, string> });

// "phase,lead_deg:30;gain": only what is not usual is written.
export function draftsText(drafts: readonly Draft[]): string {
  return drafts.map(({ kind, texts }) => [kind, ...fieldsOf(kind).filter((one) => texts[one] !== BOUNDS[one].usual).map((one) => `${one}:${texts[one]}`)].join(",")).join(";");
}

export function draftsFrom(text: string | null): Draft[] {
  const found = (text ?? "phase").split(";").slice(0, MOST_DRAFTS).map((one): Draft => {
    const [head, ...parts] = one.split(",");
    const draft = usualDraft(head === "gain" ? "gain" : "phase");
    for (const part of parts) {
      const [name, value = ""] = part.split(":"), field = FIELDS.find((known) => known === name);
      if (field && (value === "" || Number.isFinite(Number(value)))) draft.texts[field] = value;
    }
    return draft;
  });
  return found.length ? found : [usualDraft("phase")];
}

// What the service is asked; null while a number is out of its bounds.
export function bodyOf(model: string, { kind, texts }: Draft): Record<string, string | number> | null {
  if (!model) return null;
  const body: Record<string, string | number> = { model, stabilisation: kind };
  for (const field of fieldsOf(kind)) {
    const { least, most, usual } = BOUNDS[field], text = texts[field].trim();
    if (text === "" && usual === "") continue;
    const value = Number(text);
    if (text === "" || !(value >= least && value <= most)) return null;
    body[field] = value;
  }
  return body;
}

export const nameOf = (at: number, { kind }: Draft): string => (kind === "phase" ? t("{letter} lead", { letter: "ABCD"[at] ?? "" }) : t("{letter} notch", { letter: "ABCD"[at] ?? "" }));
