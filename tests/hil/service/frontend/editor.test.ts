// Files as they are written: what may stand where, values as a form, and what differs between versions.

import assert from "node:assert/strict";
import test from "node:test";
import { diffOf } from "../../../../hil/service/frontend/src/editor/diff.ts";
import { offersAt } from "../../../../hil/service/frontend/src/editor/offers.ts";
import { placeIn } from "../../../../hil/service/frontend/src/editor/place.ts";
import { changed, scalarsOf } from "../../../../hil/service/frontend/src/editor/scalars.ts";
import { nextName } from "../../../../hil/service/frontend/src/views/given/kinds.ts";

const MODEL = {
  properties: {
    kind: { enum: ["rigid", "two_inertia"], description: "which equations" }, parameters: { type: "object" }, wheel_radius_m: { type: "number", minimum: 0.01, maximum: 10 },
    effects: { type: "array", items: { type: "object", properties: { id: { enum: ["backlash", "dead_time"] } }, required: ["id"], allOf: [
      { if: { properties: { id: { const: "backlash" } } }, then: { properties: { half_gap_rad: { type: "number", description: "rad: half of the gap" } } } },
      { if: { properties: { id: { const: "dead_time" } } }, then: { properties: { extra_delay_s: { type: "number" } } } },
    ] } },
    limits: { $ref: "#/$defs/Limits" },
  },
  required: ["kind"],
  allOf: [
    { if: { properties: { kind: { const: "rigid" } }, required: ["kind"] }, then: { properties: { parameters: { properties: { motor_inertia: { type: "number", description: "kg m2" } } } } } },
    { if: { properties: { kind: { const: "two_inertia" } }, required: ["kind"] }, then: { properties: { parameters: { properties: { shaft_stiffness: { type: "number", description: "N m/rad" } } } } } },
  ],
  $defs: { Limits: { type: "object", properties: { motor_torque_nm: { type: "number" } } } },
};
const PLAN = {
  properties: { name: { type: "string" }, steps: { type: "array", items: { $ref: "#/$defs/step" } }, criteria: { type: ["array", "null"], items: { properties: { metric: { enum: ["peak", "ripple"] } } } } },
  $defs: { step: { type: "object", properties: { hold_speed: { type: "object", properties: { speed_km_h: { description: "km/h" }, duration_s: {} } }, wait: { type: "object", properties: { duration_s: {} } } } } },
};
// The cursor stands at the bar.
const at = (text: string): [string, number] => [text.replace("|", ""), text.indexOf("|")];
const toml = (text: string): string[] => offersAt(MODEL, "toml", ...at(text)).map((one) => one.inserted);
const yaml = (text: string): string[] => offersAt(PLAN, "yaml", ...at(text)).map((one) => one.inserted);

test("keys of a TOML file are offered by their table, without those that stand there", () => {
  assert.deepEqual(toml("|"), ["kind = ", "wheel_radius_m = "]);
  assert.deepEqual(toml('kind = "rigid"\nwh|'), ["wheel_radius_m = "]);
  assert.deepEqual(toml('kind = "rigid"\n[|'), ["parameters", "effects", "limits"]);
  assert.deepEqual(toml("[limits]\n|"), ["motor_torque_nm = "]);
  assert.deepEqual(toml("# a word |"), []);
});

test("what was chosen decides which keys are offered", () => {
  assert.deepEqual(toml('kind = "rigid"\n[parameters]\n|'), ["motor_inertia = "]);
  assert.deepEqual(toml('kind = "two_inertia"\n[parameters]\n|'), ["shaft_stiffness = "]);
  assert.deepEqual(toml("[[effects]]\n|"), ["id = "]);
  assert.deepEqual(toml('[[effects]]\nid = "backlash"\n|'), ["half_gap_rad = "]);
  assert.deepEqual(toml('[[effects]]\nid = "dead_time"\n[[effects]]\nid = "backlash"\n|'), ["half_gap_rad = "]);
});

test("values that may stand are offered, in quotation marks where the file needs them", () => {
  assert.deepEqual(toml("kind = |"), ['"rigid"', '"two_inertia"']);
  assert.deepEqual(toml('kind = "tw|'), ['"two_inertia"']);
  assert.deepEqual(yaml("criteria:\n  - metric: |"), ["peak", "ripple"]);
});

test("what is typed is replaced, and nothing else", () => {
  const text = 'kind = "rigid"\nwh', [offer] = offersAt(MODEL, "toml", text, text.length);
  assert.equal(offer && text.slice(0, offer.from) + offer.inserted, 'kind = "rigid"\nwheel_radius_m = ');
});

test("steps of a plan and their keys are offered by the way to them", () => {
  assert.deepEqual(yaml("name: a\n|"), ["steps: ", "criteria: "]);
  assert.deepEqual(yaml("steps:\n  - |"), ["hold_speed: ", "wait: "]);
  assert.deepEqual(yaml("steps:\n  - wait: {duration_s: 1}\n  - hold_speed: {speed_km_h: 3, |"), ["duration_s: "]);
  assert.deepEqual(yaml("steps:\n  - hold_speed:\n      duration_s: 1\n      |"), ["speed_km_h: "]);
  assert.deepEqual(yaml("steps:\n- hold_speed: {sp|"), ["speed_km_h: "]);
  assert.deepEqual(yaml("steps:\n  - wait: {duration_s: 1}\nna|"), ["name: "]);
});

test("whatever stands in a text, a place is found or none", () => {
  for (const text of ["[", "[[", "]", "a = {b = {", "- - -", "{{{", "\t\t- :", "=", "[a.b\n= 3", '"""\n[x]\n"""']) for (let place = 0; place <= text.length; place += 1) for (const kind of ["toml", "yaml"] as const) {
    placeIn(kind, text, place);
    offersAt(kind === "toml" ? MODEL : PLAN, kind, text, place);
  }
});

test("a value is changed where it stands, and stays what it is", () => {
  const text = 'kind = "rigid" # of it\nwheel_radius_m = 0.33\n[parameters]\nmotor_inertia = 2e-2 # kg m2\nnothing = 1\n';
  const found = scalarsOf(MODEL, text);
  assert.deepEqual(found.map((one) => [one.table, one.key.name, one.value, one.key.about]), [["", "kind", '"rigid"', "which equations"], ["", "wheel_radius_m", "0.33", ""], ["parameters", "motor_inertia", "2e-2", "kg m2"]]);
  assert.equal(changed(text, found[2]!, "0.03"), text.replace("2e-2", "0.03"));
  assert.equal(changed(text, found[0]!, "two_inertia"), text.replace('"rigid"', '"two_inertia"'));
  assert.deepEqual([found[1]!.key.lower, found[1]!.key.upper], [0.01, 10]);
});

test("two versions differ in the lines that differ", () => {
  const lines = (text: string, other: string) => diffOf(text, other).map((one) => `${one.kind[0]}${one.text}`);
  assert.deepEqual(lines("a\nb\nc", "a\nx\nc"), ["sa", "gb", "nx", "sc"]);
  assert.deepEqual(lines("a", "a"), ["l1"]);
  assert.deepEqual(lines("b\nc\na", "c\na\nb"), ["gb", "sc", "sa", "nb"]);
  const many = Array.from({ length: 20 }, (_, count) => `line ${count}`);
  assert.deepEqual(lines(many.join("\n"), [...many.slice(0, 19), "other"].join("\n")), ["l16", "sline 16", "sline 17", "sline 18", "gline 19", "nother"]);
});

test("whatever two texts are, each can be read from what differs", () => {
  let seed = 7;
  const drawn = () => { seed = (seed * 48271) % 2147483647; return seed; };
  for (let round = 0; round < 200; round += 1) {
    const [one, other] = [0, 1].map(() => Array.from({ length: drawn() % 9 }, () => "abc"[drawn() % 3]).join("\n")) as [string, string];
    const found = diffOf(one, other);
    if (found.some((line) => line.kind === "left out")) continue;
    assert.equal(found.filter((line) => line.kind !== "new").map((line) => line.text).join("\n"), one);
    assert.equal(found.filter((line) => line.kind !== "gone").map((line) => line.text).join("\n"), other);
  }
});

test("a new version has the next name that is free", () => {
  assert.equal(nextName("axle", ["axle"]), "axle_2");
  assert.equal(nextName("axle_2", ["axle", "axle_2", "axle_3"]), "axle_4");
  assert.ok(nextName("x".repeat(64), []).length <= 64);
});
