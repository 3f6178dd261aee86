// Differences of criteria between runs: the other minus the first, with a direction only where limits say one.

import assert from "node:assert/strict";
import test from "node:test";
import { changeOf, changeText, tabledOf, type Difference } from "../../../../hil/service/frontend/src/views/compare-changes.ts";

const changed = (first: number | null, other: number | null, better: "lower" | "higher" | "") => changeOf({ values: [first, other], better });

test("less is better below an upper limit, more above a lower one, and neither without a direction", () => {
  assert.equal(changed(100, 90, "lower")?.kind, "better");
  assert.equal(changed(100, 110, "lower")?.kind, "worse");
  assert.equal(changed(100, 110, "higher")?.kind, "better");
  assert.equal(changed(100, 90, "higher")?.kind, "worse");
  assert.equal(changed(-1, 1, "")?.kind, "open");
  assert.equal(changed(5, 5, "lower")?.kind, "same");
  assert.equal(changed(null, 5, "lower"), null);
});

test("a difference has its sign and its unit, and a share of the first where that is not zero", () => {
  assert.equal(changeText({ by: -10, kind: "better" }, { unit: "N m", relative: -0.1 }), "−10.0\u00a0N\u00a0m (−10.0%)");
  assert.equal(changeText({ by: 0.5, kind: "open" }, { unit: "s", relative: null }), "+0.50\u00a0s");
});

const difference = (kind: Difference["kind"], name: string): Difference => ({ kind, name, first: "1", other: "2", unit: "" });

test("what the sentence about the plan has is not in the table, and all else is", () => {
  const [first, ...others] = ["a", "b"].map((name) => difference("plan", name)) as [Difference, Difference];
  const pair = { differences: [difference("plan", "title"), first, ...others, difference("model", "a")], plan_summary: [{ ...first }] };
  assert.deepEqual(tabledOf(pair).map(({ kind, name }) => `${kind} ${name}`), ["plan title", "plan b", "model a"]);
});
