// One click from a run to its comparison with the best of those that passed the same criteria.

import type { JSX } from "preact";
import { to } from "../../addresses.ts";
import type { BestRun as Best, Run } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { percent } from "../../format.ts";
import { t, tn } from "../../i18n/text.ts";
import { valuesOf } from "./run-values.ts";

// In words, what else is different beside the result.
const differsOf = (of: Run, best: Run, otherValues: Record<string, number>): string =>
  [
    best.plan === of.plan ? "" : t("other plan: {plan}", { plan: best.plan }),
    best.bench === of.bench ? "" : t("other bench: {bench}", { bench: best.bench }),
    Object.keys(otherValues).length ? t("other values: {values}", { values: valuesOf({ values: otherValues }) }) : "",
  ].filter(Boolean).join("; ");

export function BestRun({ of }: { of: Run }): JSX.Element | null {
  const best = useData<Best>(`/comparisons/best?run=${of.id}`).data;
  if (!best?.run || best.margin == null) return null;
  const values = { run: best.run.id, margin: percent(best.margin, 1), differs: differsOf(of, best.run, best.other_values ?? {}) };
  const why = t("Its smallest margin is {margin}, of {criterion}.", { margin: values.margin, criterion: best.criterion });
  if (best.run.id === of.id) return <span class="quiet" title={why}>{tn("The only run that passed these criteria: margin {margin}", "The best of the {count} runs most like it that passed these criteria: margin {margin}", best.among, values)}</span>;
  return <a href={to.compare(of.id, best.run.id)} title={why}>{values.differs ? t("Compare with the best run ({run}: {differs}; margin {margin})", values) : t("Compare with the best run ({run}, margin {margin})", values)}</a>;
}
