// The palette's order, and numbers as people read them.

import assert from "node:assert/strict";
import test from "node:test";
import { figure, limitText, wordsOf } from "../../../../hil/service/frontend/src/format.ts";
import { found, type Entry } from "../../../../hil/service/frontend/src/shell/matching.ts";

const ENTRIES: Entry[] = [
  { kind: "plan", name: "commissioning", about: "From a chirp to acceptance" },
  { kind: "plan", name: "acceptance", about: "Vibration suppression" },
  { kind: "bench", name: "rear-axle", about: "Bench hall 2" },
  { kind: "run", name: "Run 17", about: "acceptance, rear-axle, pass" },
];
const names = (text: string) => found(ENTRIES, text, 9).map(({ name }) => name);

test("names that begin with the words come first, then those that tell of them", () => assert.deepEqual(names("accep"), ["acceptance", "commissioning", "Run 17"]));
test("a name that is typed whole comes before those that begin with it", () => {
  const longer: Entry = { kind: "plan", name: "acceptance_low_friction", about: "" };
  assert.deepEqual(found([longer, ...ENTRIES], "acceptance", 2).map(({ name }) => name), ["acceptance", "acceptance_low_friction"]);
});
test("every word has to be there, in any order", () => {
  assert.deepEqual(names("axle rear"), ["rear-axle", "Run 17"]);
  assert.deepEqual(names("axle nothing"), []);
});
test("without words all are offered in their order, as many as fit", () => assert.equal(found(ENTRIES, "", 2)[0]?.name, "commissioning"));

const STOP: Entry = { kind: "command", name: "Not-Halt", about: "alle Prüfstände", also: "command Emergency stop", byName: "Not-Halt Emergency stop" };
const stopIn = (text: string) => found([...ENTRIES, STOP], text, 9).includes(STOP);

test("a stop is found by its name only, and by no single letters", () => {
  for (const text of ["stop", "emergency", "emer", "Emergency Stop", "not-halt", "halt", "Not-Halt"]) assert.ok(stopIn(text), text);
  for (const text of ["", "e", "s", "st", "sto", "not", "e s", "command", "alle", "ergency", "emergency exit"]) assert.ok(!stopIn(text), text);
  assert.ok(found([{ ...STOP, name: "非常停止", byName: "非常停止 Emergency stop" }], "非常", 9).length);
});

test("figures have the digits that can be read at a glance", () => {
  assert.deepEqual([figure(373.4, "N m"), figure(-12.34), figure(0), figure(null), figure(0.5, "1")], ["373\u00a0N\u00a0m", "−12.3", "0.00", "–", "0.50"]);
  assert.equal(limitText(400, null, "N m"), "≤\u00a0400\u00a0N\u00a0m");
  assert.equal(limitText(null, null), "–");
});
test("a channel's name has its unit at its end", () => {
  assert.deepEqual([wordsOf("shaft_torque_left_nm"), wordsOf("motor_speed_rad_s"), wordsOf("gear")], ["shaft torque left", "motor speed", "gear"]);
});
