// Numbers as they are typed: a decimal comma is never dropped.

import assert from "node:assert/strict";
import test from "node:test";
import { numberIn, POINTED, pointed, whyNoNumber } from "../../../../hil/service/frontend/src/ui/typed-numbers.ts";
import { areUsual, valuesOf, wrongIn } from "../../../../hil/service/frontend/src/views/plans/typed-values.ts";
import type { Plan } from "../../../../hil/service/frontend/src/api/types.ts";

test("a decimal comma is a decimal point", () => {
  assert.deepEqual(["20,5", "-0,125", ",5", "5,", "1,5e3", "２０．５", "−3"].map((one) => pointed(one, "en")), ["20.5", "-0.125", "0.5", "5", "1.5e3", "20.5", "-3"]);
  assert.equal(numberIn("20,5"), 20.5);
});

test("a comma that may group digits is refused where readers group so, and is decimal elsewhere", () => {
  assert.equal(pointed("1,200", "en"), null);
  assert.equal(pointed("1,200", "de"), "1.200");
  assert.equal(whyNoNumber("1,200", {}, "en"), "\"1,200\" may be two numbers: write 1.200 or 1200.");
});

test("a point that may group digits is refused where readers group so, unless a field was given it", () => {
  assert.equal(pointed("200.000", "de"), null);
  assert.equal(whyNoNumber("1.250", {}, "de"), "\"1.250\" may be two numbers: write 1,250 or 1250.");
  assert.deepEqual(["0.125", "20.5", "8.7144"].map((one) => pointed(one, "de")), ["0.125", "20.5", "8.7144"]);
  assert.equal(whyNoNumber("8.714", {}, POINTED), "");
});

test("what is no number is refused", () => {
  for (const typed of ["", "-", "1.234,5", "1,234.5", "20 5", "abc", "0x10", "Infinity", "1e999"]) assert.equal(pointed(typed, "en"), null, typed);
  assert.match(whyNoNumber("1.234,5", {}), /no number/);
  assert.match(whyNoNumber("2.5", { whole: true }), /whole/);
  assert.equal(whyNoNumber("", {}), "");
});

const PLAN = { variables: { torque_nm: { default: 150, unit: "N m", description: "", lower: -300, upper: 300 } } } as unknown as Plan;

test("a value that is refused is named with its bounds", () => {
  assert.equal(wrongIn(PLAN, {}), "");
  assert.equal(wrongIn(PLAN, { torque_nm: "500" }), "torque_nm in N m: 500 is beyond its bounds: -300 to 300.");
  assert.equal(wrongIn(PLAN, { torque_nm: "" }), "torque_nm in N m: It is empty: write a number.");
  assert.deepEqual([valuesOf(PLAN, { torque_nm: "20,5" }), areUsual(PLAN, { torque_nm: "150,0" }), areUsual(PLAN, { torque_nm: "200" })], [{ torque_nm: 20.5 }, true, false]);
});

test("of a very long text a message has the two ends", () => {
  for (const typed of ["9".repeat(300), "x".repeat(10_000), "9".repeat(10_000), `0.${"1".repeat(10_000)}`]) assert.ok(whyNoNumber(typed, { max: 0, min: 0, whole: true }).length < 150, typed.slice(0, 3));
});
