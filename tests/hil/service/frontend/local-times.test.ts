import assert from "node:assert/strict";
import { test } from "node:test";
import { dayOf, fieldOf, momentOf, nextHour, shiftAt } from "../../../../hil/service/frontend/src/views/team/local-times.ts";

test("a moment goes into a field and comes back with its zone", () => {
  const at = new Date(2026, 2, 5, 7, 4);
  assert.equal(fieldOf(at), "2026-03-05T07:04");
  assert.equal(dayOf(at), "2026-03-05");
  assert.equal(momentOf(fieldOf(at)), at.toISOString());
});

test("what is no moment is none", () => {
  for (const field of ["", "tomorrow", "2026-99-99T00:00"]) assert.equal(momentOf(field), null);
});

test("the next hour is whole, also of the next day", () => {
  assert.equal(fieldOf(nextHour(new Date(2026, 11, 31, 23, 30))), "2027-01-01T00:00");
});

test("a shift is guessed by the hour", () => {
  const shifts = [5, 6, 13, 14, 21, 22].map((hour) => shiftAt(new Date(2026, 0, 1, hour)));
  assert.deepEqual(shifts, ["night", "early", "early", "late", "late", "night"]);
});
