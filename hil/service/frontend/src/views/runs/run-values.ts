// The values that a run set, in a line.

import type { Run } from "../../api/types.ts";
import { exact } from "../../format.ts";

export const valuesOf = ({ values }: Pick<Run, "values">): string => Object.entries(values).map(([name, value]) => `${name} = ${exact(value)}`).join(", ");
