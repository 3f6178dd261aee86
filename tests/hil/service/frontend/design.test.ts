// Drafts of controllers: in the address of the design studio, and as the service is asked about them.

import assert from "node:assert/strict";
import test from "node:test";
import { bodyOf, draftsFrom, draftsText, fieldsOf, MOST_DRAFTS, usualDraft, type Draft } from "../../../../hil/service/frontend/src/views/design/drafts.ts";
import { loadedBy } from "../../../../hil/service/frontend/src/views/design/loaded-controllers.ts";

const moved = (draft: Draft, field: keyof Draft["texts"], text: string): Draft => ({ ...draft, texts: { ...draft.texts, [field]: text } });

test("drafts come back from the text that they were written to, and what is usual is not written", () => {
  const drafts = [usualDraft("phase"), moved(usualDraft("gain"), "notch_hz", "14"), moved(usualDraft("phase"), "lead_deg", "20.5")];
  assert.equal(draftsText(drafts), "phase;gain,notch_hz:14;phase,lead_deg:20.5");
  assert.deepEqual(draftsFrom(draftsText(drafts)), drafts);
});

test("nonsense in an address is the usual draft, and there are not more than can be told apart", () => {
  assert.deepEqual(draftsFrom(null), [usualDraft("phase")]);
  assert.deepEqual(draftsFrom("phase,lead_deg:much,size:3"), [usualDraft("phase")]);
  assert.equal(draftsFrom("gain;".repeat(9)).length, MOST_DRAFTS);
});

test("the service is asked for the numbers of the kind, and not while one is out of its bounds", () => {
  assert.deepEqual(bodyOf("m", usualDraft("phase")), { model: "m", stabilisation: "phase", lead_deg: 36, lead_hz: 40, pole_rad_s: 0.3 });
  assert.deepEqual(bodyOf("m", usualDraft("gain")), { model: "m", stabilisation: "gain", notch_width: 2, notch_depth: 0.08, pole_rad_s: 0.3 });
  assert.equal(bodyOf("m", moved(usualDraft("gain"), "notch_hz", "14"))?.["notch_hz"], 14);
  for (const text of ["", "0.5", "86", "x"]) assert.equal(bodyOf("m", moved(usualDraft("phase"), "lead_deg", text)), null, text);
  assert.equal(bodyOf("", usualDraft("phase")), null);
  assert.ok(!fieldsOf("gain").includes("lead_deg"));
});

test("controllers that a plan loads are found in its text, each once", () => {
  const text = "steps:\n  - set_controller: {file: a.toml}\n  - set_controller:\n      file: 'b.toml'\n  - set_controller: {file: a.toml}\n";
  assert.deepEqual(loadedBy(text), ["a.toml", "b.toml"]);
  assert.deepEqual(loadedBy("steps: []"), []);
});
