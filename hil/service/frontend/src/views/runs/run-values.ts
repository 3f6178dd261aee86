// The values that a run set, in a line; and how long it took.

import type { Run } from "../../api/types.ts";
import { duration, exact } from "../../format.ts";

export const valuesOf = ({ values }: Pick<Run, "values">): string => Object.entries(values).map(([name, value]) => `${name} = ${exact(value)}`).join(", ");

// From its beginning to its end by the clock; '' of one that has not ended, or never began.
export const tookOf = ({ started_at: began, ended_at: ended }: Pick<Run, "started_at" | "ended_at">): string => (began && ended ? duration(Math.max(0, (Date.parse(ended) - Date.parse(began)) / 1000)) : "");
