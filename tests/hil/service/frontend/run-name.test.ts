// Runs of one title are told apart by their plans, and runs of one plan by the values that they were given.

import assert from "node:assert/strict";
import test from "node:test";
import { detailsOf, nameOf, shortNameOf } from "../../../../hil/service/frontend/src/views/runs/run-name.ts";

const run = (plan: string, title: string, values: Record<string, number> = {}) => ({ plan, title, values });

test("a run has its title, its plan and its values", () => {
  assert.equal(nameOf(run("tip_in", "Tip-in at 0 and 20 km/h", { torque_nm: 380, "speed_km_h": 2.5 })), "Tip-in at 0 and 20 km/h (tip_in, torque_nm = 380, speed_km_h = 2.5)");
  assert.equal(nameOf(run("acceptance_200", "Acceptance")), "Acceptance (acceptance_200)");
  assert.equal(shortNameOf(run("tip_in", "Tip-in at 0 and 20 km/h", { torque_nm: 380 })), "tip_in, torque_nm = 380");
  assert.notEqual(nameOf(run("acceptance", "Acceptance")), nameOf(run("acceptance_200", "Acceptance")));
});

test("nothing stands twice where a plan has no title of its own", () => {
  assert.equal(nameOf(run("short", "")), "short");
  assert.equal(nameOf(run("tip_in", "Tip in")), "Tip in");
  assert.equal(nameOf(run("short", "short", { torque_nm: 1 })), "short (torque_nm = 1)");
  assert.equal(detailsOf(run("short", "")), "");
});
