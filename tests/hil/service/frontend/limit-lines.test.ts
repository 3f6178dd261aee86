// Which limits a run's plots show, by what names, and which of them are brought into sight.

import assert from "node:assert/strict";
import test from "node:test";
import { usualLayout } from "../../../../hil/service/frontend/src/plot/layout.ts";
import { failedIn, marksOf } from "../../../../hil/service/frontend/src/plot/limit-lines.ts";
import { limitsOf } from "../../../../hil/service/frontend/src/views/runs/failed-limits.ts";

type View = Parameters<typeof limitsOf>[0];

const bench = (channel: string, limit: number, reached = 0): View["limits"][number] => ({ channel, above: limit, below: -limit, response: "trip", reached });
const peak = (verdict: "pass" | "fail"): View["criteria"][number] => ({ id: "s.peak_shaft_torque", value: 104, unit: "N m", upper: 90, lower: null, below: "", verdict, margin: null, title: "", reason: "", source: "plan" });
const MARKS: View["marks"] = [{ kind: "segment", name: "s", text: "", start_s: 1, step_s: 1.2, end_s: 2 }];
const viewOf = (limits: View["limits"], criteria: View["criteria"] = []): View => ({ limits, criteria, marks: MARKS });

test("a limit of the bench is named by its channel, and one of several channels by all of them", () => {
  const limits = limitsOf(viewOf([bench("motor_torque_ref_nm", 150), bench("motor_torque_nm", 150), bench("shaft_torque_nm", 600)]));
  assert.deepEqual(marksOf(limits, ["motor_torque_ref_nm", "motor_torque_nm"], "N m").map(({ label }) => label), ["motor torque ref, motor torque: limit 150\u00a0N\u00a0m", "motor torque ref, motor torque: limit −150\u00a0N\u00a0m"]);
  assert.deepEqual(failedIn(limits, ["shaft_torque_nm"], { from: 0, to: 3 }, -10, 50), []);
});

test("a criterion that failed is a line from its step to the end of its segment, one that passed is none", () => {
  assert.deepEqual(limitsOf(viewOf([], [peak("pass")])), []);
  const limits = limitsOf(viewOf([], [peak("fail")]));
  assert.deepEqual(marksOf(limits, ["shaft_torque_nm"], "N m"), [{ value: 90, failed: true, holds: { from: 1.2, to: 2 }, label: "Peak of the shaft torque: limit 90.0\u00a0N\u00a0m" }]);
  assert.deepEqual(failedIn(limits, ["shaft_torque_nm"], { from: 1.5, to: 1.6 }, -10, 50), [90]);
  assert.deepEqual(failedIn(limits, ["shaft_torque_nm"], { from: 0, to: 1 }, -10, 50), []); // it does not hold there
});

test("a limit that tripped is in sight on the side where it was reached, on a plot of its channel", () => {
  const limits = limitsOf(viewOf([bench("shaft_torque_left_nm", 600, 1), bench("motor_torque_nm", 150)]));
  assert.deepEqual(failedIn(limits, ["shaft_torque_left_nm"], { from: 0, to: 3 }, -590, 100), [-600]);
  const names = ["motor_speed_rad_s", "shaft_torque_nm", "shaft_torque_left_nm", "motor_torque_nm"];
  assert.deepEqual(usualLayout(names, ["shaft_torque_left_nm", "shaft_torque_nm"]).at(-1), { kind: "time", channels: ["shaft_torque_left_nm"] });
  assert.equal(usualLayout(names, ["shaft_torque_nm"]).length, usualLayout(names).length);
});
