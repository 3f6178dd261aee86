// Every view has an address that says it, and an address that says nothing is told apart.

import assert from "node:assert/strict";
import test from "node:test";
import { placeOf, placeOfFormer, titleOf, to } from "../../../../hil/service/frontend/src/addresses.ts";

test("what an address was written from is read from it", () => {
  assert.deepEqual(placeOf(to.bench("rear axle/2")), { view: "bench", bench: "rear axle/2" });
  assert.deepEqual(placeOf(to.panel("sim")), { view: "panel", bench: "sim" });
  assert.deepEqual([placeOf(to.wall()), placeOf(to.wall("sim"))], [{ view: "wall", bench: null }, { view: "wall", bench: "sim" }]);
  assert.deepEqual(placeOf(to.run(17)), { view: "run", run: 17 });
  assert.deepEqual(placeOf(to.plan("driveability")), { view: "plan", name: "driveability" });
  assert.deepEqual(placeOf(to.diagnosis(3)), { view: "diagnosis", id: 3 });
  assert.deepEqual(placeOf(to.identification(3)), { view: "identification", id: 3 });
  assert.deepEqual(placeOf(to.benchFile("rear_axle")), { view: "bench-file", name: "rear_axle" });
  assert.deepEqual(placeOf(to.recording(5)), { view: "recording", id: 5 });
  assert.deepEqual(placeOf(to.campaign(4)), { view: "campaign", id: 4 });
  for (const view of ["benches", "runs", "compare", "trends", "plans", "models", "controllers", "bench-files", "design", "recordings", "identifications", "diagnoses", "campaigns", "audit", "settings", "glossary"] as const) assert.deepEqual(placeOf(to.list(view)), { view });
});

test("the address without a view is that of the benches", () => {
  assert.deepEqual(placeOf("/"), { view: "benches" });
  assert.deepEqual(placeOf(""), { view: "benches" });
});

test("an address of nothing is missing, whatever stands in it", () => {
  for (const path of ["/nothing", "/runs/0", "/runs/x", "/runs/1/2", "/benches/sim/other", "/settings/a", "/wall/sim/x", "/plans/%E0%A4%A"]) assert.equal(placeOf(path).view, "missing", path);
});

test("titles tell views apart", () => {
  assert.equal(titleOf(placeOf("/runs/17")), "Run 17");
  assert.equal(titleOf(placeOf("/benches/sim/panel")), "Operator panel of sim");
});

test("an address of the former page leads to its bench", () => {
  assert.equal(placeOfFormer("/", "#rear%20axle"), "/benches/rear%20axle");
  for (const [path, hash] of [["/", ""], ["/", "#"], ["/runs", "#sim"], ["/", "#%E0%A4%A"]] as const) assert.equal(placeOfFormer(path, hash), null, path + hash);
});
