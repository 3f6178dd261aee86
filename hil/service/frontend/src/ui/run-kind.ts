// The one word for how a run stands, and so its badge: of its state and its verdict.

import type { Run } from "../api/types.ts";
import { kindInWords } from "./kinds.ts";

// One that was interrupted has the verdict of a part, one that ended without a verdict has failed to give one.
export const verdictOf = (run: Ended): string => (run.state === "ended" ? onPurposeOf(run) || (run.verdict ?? "error") : run.state);

type Ended = Pick<Run, "state" | "verdict"> & Partial<Pick<Run, "reason">>;

const STOPPED = /^(emergency stop: (requested by |the operator typed e)|stopped before it began: emergency stop)/;
const ENDED_EARLY = /^stopped by the operator($|, who did not continue at |\n)/;

// A person wanted its end: it has no verdict, and nothing has failed. '' for any other.
function onPurposeOf({ verdict, reason }: Ended): string {
  if (verdict && verdict !== "error") return "";
  return STOPPED.test(reason ?? "") ? "stopped" : ENDED_EARLY.test(reason ?? "") ? "ended_early" : "";
}

export const runInWords = (run: Ended): string => kindInWords(verdictOf(run));
