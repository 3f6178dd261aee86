import assert from "node:assert/strict";
import { test } from "node:test";
import { dayOf, fieldOf, momentOf, nextHour, shiftAt, spanProblem } from "../../../../hil/service/frontend/src/views/team/local-times.ts";

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

test("what is wrong with the times of a reservation is said by the names of their fields", () => {
  const now = new Date(2026, 2, 5, 12, 0);
  assert.equal(spanProblem("2026-03-05T13:00", "2026-03-05T14:00", now), "");
  assert.equal(spanProblem("", "2026-03-05T14:00", now), "");
  assert.match(spanProblem("2026-03-05T13:00", "2026-03-05T13:00", now), /“To” must be later than “From”/);
  assert.match(spanProblem("1900-03-05T13:00", "2026-03-05T13:00", now), /“From” is more than a day ago/);
  assert.match(spanProblem("2026-03-05T13:00", "2999-03-05T13:00", now), /“To” is more than a year ahead/);
  assert.match(spanProblem("2026-03-05T13:00", "2026-04-06T13:00", now), /31 days/);
});
