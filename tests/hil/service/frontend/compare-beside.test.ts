// Given recordings in the address of a comparison.

import assert from "node:assert/strict";
import test from "node:test";
import { recordingsFrom, recordingsText } from "../../../../hil/service/frontend/src/views/compare-beside.ts";

test("what was written is read, with the moment of the step where it is not zero", () => {
  const chosen = [{ id: 3, step: 12.5 }, { id: 4, step: 0 }, { id: 5, step: -1 }];
  assert.equal(recordingsText(chosen), "3@12.5,4,5@-1");
  assert.deepEqual(recordingsFrom(recordingsText(chosen)), chosen);
});

test("what is no recording is left out", () => {
  assert.deepEqual(recordingsFrom(null), []);
  assert.deepEqual(recordingsFrom("0,x,3@,4@1.5"), [{ id: 4, step: 1.5 }]);
});
