// Beside the verdict of a run that passed: quantities that were measured and did not settle, and why they fail nothing.

import type { JSX } from "preact";
import type { Run, RunView } from "../../api/types.ts";
import { t, tn } from "../../i18n/text.ts";
import { isFailed, namedBy, wordsOfCriterion } from "../criterion-words.ts";
import { isPassed } from "./outcome.tsx";

export function Unsettled({ run, view }: { run: Run; view: RunView | null }): JSX.Element | null {
  const found = (view?.criteria ?? []).filter((one) => one.verdict === "did_not_settle" && !isFailed(one));
  if (!isPassed(run) || !found.length) return null;
  const segments = new Map<string, string[]>(); // by what was measured in them
  for (const one of found) segments.set(wordsOfCriterion(one), [...(segments.get(wordsOfCriterion(one)) ?? []), namedBy(one.id).segment]);
  const names = [...segments].map(([what, ones]) => { const where = ones.filter(Boolean).join(", "); return where ? t("{what} in {segment}", { what, segment: where }) : what; }).join("; ");
  return (
    <p>{tn("One measured quantity did not settle before the end of its segment. It has no limit in the plan, so it counts neither for nor against the run: {names}.", "{count} measured quantities did not settle before the end of their segments. They have no limit in the plan, so they count neither for nor against the run: {names}.", found.length, { names })}{" "}
      <a href="#section-criteria" onClick={(event) => { event.preventDefault(); document.getElementById("section-criteria")?.scrollIntoView(); }}>{t("Show them among the criteria")}</a></p>
  );
}
