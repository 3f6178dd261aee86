// Values as people read them.

import assert from "node:assert/strict";
import test from "node:test";
import { figure, figuresIn, joined, reading } from "../../../../hil/service/frontend/src/format.ts";

const NBSP = "\u00a0";

test("a live value has the decimals of its unit, whatever its size, so that values side by side are alike", () => {
  assert.deepEqual([60, 200, -3.24, 1234.56, 0].map((one) => reading(one, "N m")), ["60.0", "200.0", "−3.2", "1,234.6", "0.0"].map((text) => `${text}${NBSP}N${NBSP}m`));
  assert.deepEqual(["rad/s", "m/s", "km/h", "rad", "°C", "s"].map((unit) => reading(12.34567, unit, "")), ["12.3", "12.35", "12.3", "12.3457", "12.3", "12.346"]);
});

test("a live value does not jump between zero and minus zero", () => {
  assert.deepEqual([-0.04, 0.04, -0.06].map((one) => reading(one, "N m", "")), ["0.0", "0.0", "−0.1"]);
});

test("of a unit without decimals of its own, and of what is no number, it is as any figure", () => {
  for (const value of [0.01234, 60, 200, null, undefined, Number.NaN, Number.POSITIVE_INFINITY, 2e6]) assert.equal(reading(value, "bar"), figure(value, "bar"));
  assert.deepEqual([reading(null, "N m"), reading(2e6, "N m")], [figure(null, "N m"), figure(2e6, "N m")]);
});

test("a value stays on one line with a unit of several words", () => assert.equal(joined("196", "N m"), `196${NBSP}N${NBSP}m`));

test("figures in a text are the reader's, and versions, addresses and names are not touched", () => {
  assert.equal(figuresIn("≥ -0.5 ≤ 10.25, 1.5e-3 N m at 0.6 s.", ","), "≥ −0,5 ≤ 10,25, 1,5e-3 N m at 0,6 s.");
  for (const text of ["10.0.0.7:5000", "socket://h.1.2", "1.2.3", "a1.5", "2026-11-28"]) assert.equal(figuresIn(text, ","), text);
});
