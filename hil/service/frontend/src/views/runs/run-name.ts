// How a run is named everywhere: the title of its plan, and what tells it from others with that title.

import type { Run } from "../../api/types.ts";
import { valuesOf } from "./run-values.ts";

type Named = Pick<Run, "title" | "plan" | "values">;

export const titleOf = ({ title, plan }: Pick<Run, "title" | "plan">): string => title || plan;

// A title that says no more than the plan's name: "Tip in" and tip_in.
const bare = (words: string): string => words.toLowerCase().replace(/[\s_-]+/g, " ");

// Its plan, which copies share a title with, and the values that it was given; '' where there is nothing to tell.
export const detailsOf = (run: Named): string => [bare(titleOf(run)) === bare(run.plan) ? "" : run.plan, valuesOf(run)].filter(Boolean).join(", ");

// In a line: "Tip-in at 0 and 20 km/h (tip_in, torque_nm = 380)".
export function nameOf(run: Named): string {
  const details = detailsOf(run);
  return details ? `${titleOf(run)} (${details})` : titleOf(run);
}

// Where there is room for a line and no more, without the title that others may share: "tip_in, torque_nm = 380".
export const shortNameOf = (run: Named): string => [run.plan, valuesOf(run)].filter(Boolean).join(", ");
