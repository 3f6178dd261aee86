// Values as people read them.

import assert from "node:assert/strict";
import test from "node:test";
import { figure, reading } from "../../../../hil/service/frontend/src/format.ts";

const NBSP = "\u00a0";

test("a live value has the decimals of its unit, whatever its size, so that values side by side are alike", () => {
  assert.deepEqual([60, 200, -3.24, 1234.56, 0].map((one) => reading(one, "N m")), ["60.0", "200.0", "−3.2", "1,234.6", "0.0"].map((text) => `${text}${NBSP}N m`));
  assert.deepEqual(["rad/s", "m/s", "km/h", "rad", "°C", "s"].map((unit) => reading(12.34567, unit, "")), ["12.3", "12.35", "12.3", "12.3457", "12.3", "12.346"]);
});

test("a live value does not jump between zero and minus zero", () => {
  assert.deepEqual([-0.04, 0.04, -0.06].map((one) => reading(one, "N m", "")), ["0.0", "0.0", "−0.1"]);
});

test("of a unit without decimals of its own, and of what is no number, it is as any figure", () => {
  for (const value of [0.01234, 60, 200, null, undefined, Number.NaN, Number.POSITIVE_INFINITY, 2e6]) assert.equal(reading(value, "bar"), figure(value, "bar"));
  assert.deepEqual([reading(null, "N m"), reading(2e6, "N m")], [figure(null, "N m"), figure(2e6, "N m")]);
});
