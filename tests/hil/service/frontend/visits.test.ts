// Since when what failed is told: the last visit, a day at least, a week at most.

import assert from "node:assert/strict";
import test from "node:test";
import { visitedAt } from "../../../../hil/service/frontend/src/views/visits.ts";

const HOUR = 3_600_000, NOW = 1_000 * HOUR;

test("without a visit before, or after one of today, it is the last day", () => {
  assert.deepEqual(visitedAt(null, NOW), { seenMs: NOW, sinceMs: NOW - 24 * HOUR });
  assert.equal(visitedAt({ seenMs: NOW - 3 * HOUR, sinceMs: NOW - 90 * HOUR }, NOW).sinceMs, NOW - 24 * HOUR);
});

test("after a weekend it is since the last visit, also when the list is looked at again", () => {
  const monday = visitedAt({ seenMs: NOW - 62 * HOUR, sinceMs: NOW - 90 * HOUR }, NOW);
  assert.equal(monday.sinceMs, NOW - 62 * HOUR);
  assert.equal(visitedAt(monday, NOW + HOUR / 2).sinceMs, NOW - 62 * HOUR);
  assert.equal(visitedAt({ seenMs: NOW - 1000 * HOUR, sinceMs: 0 }, NOW).sinceMs, NOW - 168 * HOUR);
});
