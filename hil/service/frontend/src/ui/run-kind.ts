// The one word for how a run stands, and so its badge: of its state and its verdict.

import type { Run } from "../api/types.ts";
import { kindInWords } from "./kinds.ts";

// One that was interrupted has the verdict of a part, one that ended without a verdict has failed to give one.
export const verdictOf = (run: Pick<Run, "state" | "verdict">): string => (run.state === "ended" ? (run.verdict ?? "error") : run.state);

export const runInWords = (run: Pick<Run, "state" | "verdict">): string => kindInWords(verdictOf(run));
