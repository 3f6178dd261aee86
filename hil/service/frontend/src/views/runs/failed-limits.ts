// The limits that belong into a run's plots: those of its bench, and of the criteria that it failed.

import type { RunView } from "../../api/types.ts";
import type { ChannelLimit } from "../../plot/limit-lines.ts";
import { limitedBy } from "../compare-levels.ts";
import { isFailed, namedBy, wordsOfCriterion } from "../criterion-words.ts";

export function limitsOf(view: Pick<RunView, "limits" | "criteria" | "marks">): ChannelLimit[] {
  const ofBench = view.limits.flatMap(({ channel, above, below, reached }) =>
    [above, below].filter((value) => value != null).map((value) => ({ channel, value, what: "", failed: (reached ?? 0) > 0, holds: null })));
  const ofCriteria = view.criteria.filter(isFailed).flatMap((one) => {
    const mark = view.marks.find(({ kind, name }) => kind === "segment" && name === namedBy(one.id).segment), levels = limitedBy(one);
    const holds = mark ? { from: mark.step_s ?? mark.start_s, to: mark.end_s ?? Infinity } : null;
    return (levels?.values ?? []).map((value) => ({ channel: levels?.channel ?? "", value, what: wordsOfCriterion(one), failed: true, holds }));
  });
  return [...ofBench, ...ofCriteria];
}
