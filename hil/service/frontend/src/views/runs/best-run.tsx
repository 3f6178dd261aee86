// One click from a run to its comparison with the best of those that passed the same criteria.

import type { JSX } from "preact";
import { to } from "../../addresses.ts";
import type { BestRun as Best, Run } from "../../api/types.ts";
import { useData } from "../../data.ts";
import { percent } from "../../format.ts";
import { t, tn } from "../../i18n/text.ts";
import { valuesOf } from "./run-values.ts";

export function BestRun({ of }: { of: Run }): JSX.Element | null {
  const best = useData<Best>(`/comparisons/best?run=${of.id}`).data;
  if (!best?.run || best.margin == null) return null;
  const values = { run: best.run.id, margin: percent(best.margin, 1), values: valuesOf(best.run) };
  const why = t("Its smallest margin is {margin}, of {criterion}.", { margin: values.margin, criterion: best.criterion });
  if (best.run.id === of.id) return <span class="quiet" title={why}>{tn("The only run that passed these criteria: margin {margin}", "The best of {count} runs that passed these criteria: margin {margin}", best.among, values)}</span>;
  return <a href={to.compare(of.id, best.run.id)} title={why}>{values.values ? t("Compare with the best run ({run}: {values}, margin {margin})", values) : t("Compare with the best run ({run}, margin {margin})", values)}</a>;
}
