// Criteria in words: what is measured and where, in a sentence where one failed.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { allowed, failureOf, inOrder, isFailed, meaningOf, metricWords, namedBy, wordsOfCriterion, type Measured } from "../../../../hil/service/frontend/src/views/criterion-words.ts";

const ONE: Measured = { id: "gain_0kmh.peak_shaft_torque", value: 104.468, unit: "N m", upper: 90, verdict: "fail", source: "plan" };

test("an id of segment and metric is taken apart, any other is left as it is", () => {
  assert.deepEqual(namedBy(ONE.id), { metric: "peak_shaft_torque", segment: "gain_0kmh", below: "" });
  assert.deepEqual(namedBy("phase.v1.jerk.below.gain.v1"), { metric: "jerk", segment: "phase.v1", below: "gain.v1" });
  assert.deepEqual(namedBy("comfort"), { metric: "", segment: "", below: "" });
});

test("a criterion has its author's title, or the words of its metric, and its id where there is neither", () => {
  assert.equal(wordsOfCriterion(ONE), "Peak of the shaft torque");
  assert.equal(wordsOfCriterion({ ...ONE, title: "Load on the shafts" }), "Load on the shafts");
  assert.equal(wordsOfCriterion({ id: "s.holding", title: "Largest deviation", source: "device" }), "Largest deviation while holding");
  assert.equal(wordsOfCriterion({ id: "comfort", title: "", source: "plan" }), "comfort");
});

test("a failure is one sentence with value, limit and place", () => {
  assert.equal(failureOf(ONE), "Peak of the shaft torque in gain_0kmh: 104\u00a0N\u00a0m, allowed is ≤\u00a090.0\u00a0N\u00a0m.");
  assert.equal(failureOf({ ...ONE, id: "comfort", value: null }), "comfort: no value, allowed is ≤\u00a090.0\u00a0N\u00a0m.");
  assert.equal(allowed({ ...ONE, below: "gain", upper: null }), "below gain");
});

test("criteria of the plan come before those of any device; what failed includes what never settled in a limit", () => {
  assert.deepEqual(inOrder([{ ...ONE, id: "d", source: "device" }, ONE]).map((one) => one.id), [ONE.id, "d"]);
  assert.deepEqual([ONE, { ...ONE, verdict: "did_not_settle" }, { ...ONE, verdict: "did_not_settle", upper: null }, { ...ONE, verdict: "pass" }].map(isFailed), [true, true, false, false]);
});

test("every metric of the product has words", () => {
  const page = readFileSync(fileURLToPath(new URL("../../../../docs/reference/metrics.md", import.meta.url)), "utf8");
  const names = page.split("## What any device must do")[0]!.split("\n").filter((line) => line.startsWith("| `")).flatMap((line) => [...line.split("|")[1]!.matchAll(/`(\w+)`/g)].map((one) => one[1]!));
  assert.ok(names.length > 18, String(names.length));
  for (const name of names) {
    assert.notEqual(metricWords(name), name);
    assert.notEqual(meaningOf(name), "");
  }
});
