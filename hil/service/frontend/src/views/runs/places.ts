// Places in the curves of a run: the stretch that is shown stands in the address.

import type { RunView } from "../../api/types.ts";
import { rangeText, type Range } from "../../plot/range.ts";
import { setQuery } from "../../router.ts";

export function look(range: Range): void {
  const query = new URLSearchParams(location.search);
  query.set("t", rangeText(range));
  setQuery(query);
  document.getElementById("section-plots")?.scrollIntoView();
}

// Where a segment lies; null where the recording has none of this name, or it did not end.
export function rangeOfSegment(view: Pick<RunView, "marks">, segment: string): Range | null {
  const found = view.marks.find((mark) => mark.kind === "segment" && mark.name === segment);
  return found && found.end_s != null ? { from: found.start_s, to: found.end_s } : null;
}
