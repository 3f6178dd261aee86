// What differs from car to car: in the address of the design studio, and as the service is asked.

import assert from "node:assert/strict";
import test from "node:test";
import { carsFrom, spreadFrom, spreadText, toleranceOf, USUAL_CARS } from "../../../../hil/service/frontend/src/views/design/car-spread.ts";

test("a spread comes back from the text that it was written to, in shares and seconds for the service", () => {
  const spread = spreadFrom("dead_time_s:1.5,vehicle_inertia:10");
  assert.equal(spreadText(spread), "vehicle_inertia:10,dead_time_s:1.5");
  assert.deepEqual(toleranceOf(spread), { vehicle_inertia: 0.1, dead_time_s: 0.0015 });
});

test("nothing, and nonsense, leave it to the model's file", () => {
  for (const text of [null, "", "mass:3", "vehicle_inertia:much", "vehicle_inertia:-1", "dead_time_s:21"]) assert.equal(spreadFrom(text), null, String(text));
  assert.equal(toleranceOf(null), null);
});

test("only counts that can be chosen are taken", () => {
  assert.equal(carsFrom("20"), 20);
  assert.equal(carsFrom("0"), 0);
  for (const text of [null, "7", "x"]) assert.equal(carsFrom(text), USUAL_CARS);
});
