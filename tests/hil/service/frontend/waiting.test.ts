// Why a run waits: whatever keeps it is named, with what ends it.

import assert from "node:assert/strict";
import test from "node:test";
import type { Bench, Run } from "../../../../hil/service/frontend/src/api/types.ts";
import { whyItWaits, type Around } from "../../../../hil/service/frontend/src/views/runs/waiting-words.ts";

const RUN = { id: 9, plan: "steps", title: "Steps", values: {}, bench: "sim", requested_by: "ben", state: "queued" } as Run;
const OTHER = { ...RUN, id: 7, requested_by: "anna", state: "running" } as Run;
const around = (bench: Partial<Bench>, more: Partial<Around> = {}): Around => ({ bench: { name: "sim", state: "free", lease: "", ...bench } as Bench, running: null, queue: [RUN], ...more });
const HELD = { id: 1, bench: "sim", who: "chen", begins: "2026-11-28T10:00:00Z", ends: "2026-11-28T12:00:00Z", reason: "endurance", admitted: [] };

const CASES: [string, Run, Around, RegExp, RegExp][] = [
  ["approval", { ...RUN, state: "waiting_approval", hazard: "spins to 15,000 rpm" } as Run, around({}), /hazardous: spins to 15,000 rpm/, /other than ben/],
  ["missing", RUN, { bench: null, running: null, queue: [] }, /sim is not connected/, /in service again/],
  ["stop", RUN, around({ state: "emergency_stop" }), /emergency stop of sim is latched/, /no one is in danger.*an engineer resets the stop, here or at the bench/],
  ["away", RUN, around({ state: "away", away_since: "2026-11-28T10:00:00Z" }), /not been heard of since .*2026/, /connected again/],
  ["reservation", { ...RUN, waits_for: HELD } as Run, around({}), /reservation of chen until .*2026.*: endurance/, /when chen lets it start/],
  ["lease", RUN, around({ lease: "anna", lease_until: "2026-11-28T12:00:00Z" }), /anna has the bench until .*2026/, /anna or an engineer/],
  ["run", RUN, around({ state: "running", running: 7 }, { running: { ...OTHER, expected_end: "2026-11-28T12:00:00Z" } }), /Run 7 \(Steps, by anna\).*until about .*2026/, /when that run has ended/],
  ["run", RUN, around({ state: "running", running: 7 }, { running: { ...OTHER, prompt: { text: "?", answer_by: "", picture: "" } } }), /waits for an answer/, /operator answers/],
  ["ending", RUN, around({ state: "ending" }), /earlier service/, /by itself/],
  ["in_use", RUN, around({ state: "in_use" }), /Another program drives sim/, /has ended/],
  ["turn", RUN, around({}, { queue: [{ ...OTHER, id: 8, state: "queued" }, RUN] }), /Run 8 of anna is before it/, /its turn/],
  ["soon", RUN, around({}), /about to start/, /^$/],
];

for (const [kind, run, how, why, ends] of CASES) {
  test(`a run that waits for ${kind} says so: ${why.source}`, () => {
    const found = whyItWaits(run, how);
    assert.equal(found.kind, kind);
    assert.match(found.why, why);
    assert.match(found.ends, ends);
  });
}

test("a run waits for no lease of who asked for it, and for none behind it or held by somebody else", () => {
  assert.equal(whyItWaits(RUN, around({ lease: "ben" })).kind, "soon");
  const later = { ...OTHER, id: 10, state: "queued" } as Run, held = { ...OTHER, id: 8, state: "queued", waits_for: HELD } as Run;
  assert.equal(whyItWaits(RUN, around({}, { queue: [held, RUN, later] })).kind, "soon");
});
