// Whether what a diagnosis has made of a model is nearer to the bench than the model was.

import type { Diagnosis } from "../../api/types.ts";
import { percentOf } from "./wording.ts";

// By the runs that were held out, if there are any; as far as the figures on the page tell before from after.
export function isImproved({ effects, gap, holdout_gap: held }: Pick<Diagnosis, "effects" | "gap" | "holdout_gap">): boolean {
  const judged = Object.values(Object.keys(held).length ? held : gap);
  return effects.length > 0 || judged.some(({ before, after }) => before != null && after != null && after < before && percentOf(after) !== percentOf(before));
}
