// Entries of the audit log: what the service says in words that are translated, all else as it is.

import assert from "node:assert/strict";
import test from "node:test";
import { CATALOGUE } from "../../../../hil/service/frontend/src/i18n/language.ts";
import { catalogueOf } from "../../../../hil/service/frontend/texts.ts";

Object.assign(CATALOGUE, catalogueOf("de")); // before anything that keeps texts as constants is imported
const { detailOf, targetOf } = await import("../../../../hil/service/frontend/src/views/audit-words.ts");

test("targets and details are in the reader's words", () => {
  assert.deepEqual(["run 10", "study 3", "sim"].map(targetOf), ["Lauf 10", "Untersuchung 3", "sim"]);
  assert.deepEqual(["1 stop", "2 stops", "tip_in on sim", "tip_in on sim, torque_nm = 380"].map(detailOf), ["1 Halt", "2 Halte", "tip_in auf sim", "tip_in auf sim, torque_nm = 380"]);
  assert.equal(detailOf("look on both sides, please"), "look on both sides, please");
  assert.notEqual(detailOf("3600 s"), "3600 s");
});
