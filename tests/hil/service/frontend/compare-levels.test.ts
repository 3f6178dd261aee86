// Which limits of criteria are lines in the plot of a channel.

import assert from "node:assert/strict";
import test from "node:test";
import { failedIn, levelsOf } from "../../../../hil/service/frontend/src/views/compare-levels.ts";

const judged = (id: string, upper: number | null, lower: number | null, verdict: "pass" | "fail") => ({ id, upper, lower, verdict });
const of = (segment: string, channel: string, ...criteria: ReturnType<typeof judged>[]) => levelsOf([{ criteria }], segment, channel);

test("a limit on a value of the channel is a line in its segment, and only there", () => {
  const peak = judged("s.peak_shaft_torque", 150, null, "fail");
  assert.deepEqual(of("s", "shaft_torque_nm", peak), [{ value: 150, failed: true }]);
  assert.deepEqual(of("other", "shaft_torque_nm", peak), []);
  assert.deepEqual(of("s", "motor_speed_rad_s", peak), []);
  assert.deepEqual(of("s", "oil_c", judged("s.peak.oil_c", 90, -20, "pass")), [{ value: -20, failed: false }, { value: 90, failed: false }]);
  assert.deepEqual(of("s", "oil_c", judged("s.magnitude.oil_c", 90, null, "pass")).map(({ value }) => value), [-90, 90]);
});

test("a limit on a time or an energy is no line", () => {
  assert.deepEqual(of("s", "shaft_torque_nm", judged("s.settling_shaft_torque", 0.5, null, "fail"), judged("s.overshoot_shaft_torque", 30, null, "fail")), []);
});

test("a limit of several runs is one line, failed where one of them fails it", () => {
  const [one, other] = ["pass", "fail"].map((verdict) => ({ criteria: [judged("s.peak_shaft_torque", 150, null, verdict as "pass")] }));
  assert.deepEqual(levelsOf([one, other].filter((view) => view !== undefined), "s", "shaft_torque_nm"), [{ value: 150, failed: true }]);
});

test("runs are laid over each other in the first segment that one of them failed in", () => {
  const good = { criteria: [judged("at_0.peak_shaft_torque", 150, null, "pass"), judged("at_20.peak_shaft_torque", 150, null, "pass")] };
  const bad = { criteria: [judged("at_0.peak_shaft_torque", 150, null, "pass"), judged("at_20.peak_shaft_torque", 150, null, "fail")] };
  assert.equal(failedIn([good, bad], ["at_0", "at_20"]), "at_20");
  assert.equal(failedIn([good, good], ["at_0", "at_20"]), "");
});
