// Filters of the table of runs: in its address, and as the service is asked.

import assert from "node:assert/strict";
import test from "node:test";
import { queryFrom, sorted, ticked, toAddress, toService } from "../../../../hil/service/frontend/src/views/runs/runs-query.ts";
import { tookOf } from "../../../../hil/service/frontend/src/views/runs/run-values.ts";

test("a run took from its beginning to its end, and one that has not ended took nothing yet", () => {
  const began = "2026-11-28T10:00:00Z";
  assert.equal(tookOf({ started_at: began, ended_at: "2026-11-28T10:02:05Z" }), "2 min 5 s");
  assert.deepEqual([tookOf({ started_at: began, ended_at: null }), tookOf({ started_at: null, ended_at: began })], ["", ""]);
});

const of = (text: string) => queryFrom(new URLSearchParams(text));

test("an address without filters stays empty", () => assert.equal(toAddress(of("")).toString(), ""));

test("filters come back from the address that they were written to", () => {
  const text = "plan=acceptance&verdict=fail&text=axle&since=2026-01-02&criterion=s.peak&above=3.5&sort=value&rising=true&page=3";
  assert.deepEqual(of(toAddress(of(text)).toString()), of(text));
});

test("nonsense in an address is left out", () => {
  const query = of("since=soon&above=much&sort=size&page=-4");
  assert.deepEqual([query.since, query.above, query.sort, query.page], ["", "", "run", 1]);
});

test("the last day is in, and pages begin where the last ended", () => {
  const asked = toService(of("since=2026-01-02&until=2026-01-02&page=3"));
  assert.equal(Date.parse(asked.get("until") as string) - Date.parse(asked.get("since") as string), 86_400_000);
  assert.deepEqual([asked.get("first"), asked.get("most")], ["100", "50"]);
});

test("bounds without their criterion are not asked for", () => assert.equal(toService(of("above=3")).get("above"), null));

test("a column that is chosen again turns round, another begins with its usual end", () => {
  assert.deepEqual([sorted(of(""), "run").rising, sorted(of("sort=ended"), "ended").rising], [true, true]);
  const byPlan = sorted(of("page=4"), "plan");
  assert.deepEqual([byPlan.sort, byPlan.rising, byPlan.page], ["plan", true, 1]);
});

test("durations are sorted by the service, the longest first", () => {
  const query = sorted(of(""), "duration");
  assert.deepEqual([query.rising, toService(query).get("sort"), of("sort=duration").sort], [false, "duration", "duration"]);
});

test("ticked runs stand in the address and are not asked for", () => {
  const six = [1, 2, 3, 4, 5, 6].reduce(ticked, of("plan=short"));
  assert.equal(toAddress(ticked(six, 2)).get("chosen"), "1,3,4,5,6");
  assert.deepEqual(ticked(six, 7).chosen, [2, 3, 4, 5, 6, 7]);
  assert.deepEqual(of("chosen=4,x,-1,4,2").chosen, [4, 2]);
  assert.equal(toService(six).get("chosen"), null);
});
