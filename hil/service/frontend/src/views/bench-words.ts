// States of a bench in words.

import type { Bench } from "../api/types.ts";
import { t } from "../i18n/text.ts";

export const STATES: Record<Bench["state"], string> = {
  free: t("Free"), running: t("Running"), ending: t("Ending a lost run"), in_use: t("In use"), emergency_stop: t("Emergency stop"), away: t("Agent not connected"),
};

export function headlineOf(bench: Bench, title: string | null): string {
  if (bench.stop_confirmed === false) return t("Emergency stop asked for, NOT CONFIRMED");
  if (title !== null && bench.state === "running") return t("Running: {plan}", { plan: title });
  return STATES[bench.state];
}

// Where a bench is and who has it, behind its title.
export const aboutBench = (bench: Bench, title: string): string =>
  [title, bench.simulated ? t("simulated") : "", bench.machine ? t("at {machine}", { machine: bench.machine }) : "", bench.lease ? t("reserved by {person}", { person: bench.lease }) : ""].filter(Boolean).join(", ");
