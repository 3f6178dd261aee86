// A campaign's file from its form.

import assert from "node:assert/strict";
import test from "node:test";
import { boundsOf, campaignText, isWrong, NOTHING, plainKeys, whyNoName, type Property } from "../../../../hil/service/frontend/src/views/campaigns/campaign-form.ts";

const SCHEMA: Property = {
  properties: {
    format: { type: "integer" }, name: { type: "string" }, title: { type: "string" }, draws: { type: "integer", minimum: 0, maximum: 9 }, controllers: { type: "array" },
    pass_share: { anyOf: [{ type: "number", minimum: 0, maximum: 1 }, { type: "null" }] }, vary: { type: ["object", "null"] }, tolerance: { type: ["object", "null"] },
  },
};

test("texts and numbers have fields, in the order of the schema, with its bounds", () => {
  assert.deepEqual(plainKeys(SCHEMA), ["name", "title", "draws", "pass_share"]);
  assert.deepEqual(boundsOf(SCHEMA.properties?.["pass_share"] as Property), { min: 0, max: 1, whole: false });
  assert.equal(boundsOf(SCHEMA.properties?.["draws"] as Property).whole, true);
});

test("only what was chosen is written", () => assert.equal(campaignText(SCHEMA, NOTHING), "format: 1\n"));

test("what YAML would read otherwise is quoted", () => {
  const text = campaignText(SCHEMA, { ...NOTHING, plain: { name: "on", title: 'A "tip": in\n', draws: "3", pass_share: "0.9" }, lists: { controllers: ["a", "b c"] } });
  assert.equal(text, 'format: 1\nname: "on"\ntitle: "A \\"tip\\": in"\ndraws: 3\npass_share: 0.9\ncontrollers: [a, "b c"]\n');
});

test("tolerances and spans are written, empty ones are not", () => {
  const vary = [{ name: "model.vehicle_inertia", from: "250", to: "350", count: "3" }, { name: "plan.torque_nm", from: "100", to: "", count: "" }, { name: "", from: "1", to: "", count: "" }];
  const text = campaignText(SCHEMA, { ...NOTHING, vary, tolerance: { tyre_stiffness: "0.2", order_phase: "true", sensor_noise: "", dead_time_s: "false" } });
  assert.equal(text, "format: 1\nvary:\n  model.vehicle_inertia: {from: 250, to: 350, count: 3}\n  plan.torque_nm: [100]\ntolerance:\n  tyre_stiffness: 0.2\n  order_phase: true\n");
});

test("one wrong field keeps the form back, an empty one does not", () => {
  const wrong = (plain: Record<string, string>) => isWrong(SCHEMA, { ...NOTHING, plain });
  assert.equal(isWrong(SCHEMA, NOTHING), false);
  assert.equal(wrong({ name: "a-1.b", draws: "3", pass_share: "0.9" }), false);
  for (const plain of [{ draws: "1e99" }, { draws: "2.5" }, { draws: "-1" }, { pass_share: "2" }, { name: "<b>x</b>" }, { name: "n".repeat(65) }]) assert.equal(wrong(plain as unknown as Record<string, string>), true, JSON.stringify(plain));
  assert.equal(isWrong(SCHEMA, { ...NOTHING, vary: [{ name: "inertia", from: "", to: "", count: "" }] }), true);
  assert.equal(isWrong(SCHEMA, { ...NOTHING, vary: [{ name: "model.inertia", from: "1", to: "2", count: "1" }] }), true);
  assert.equal(whyNoName(""), "");
});
