// A plan as text: its name, a copy's name, and where a line lies.

import assert from "node:assert/strict";
import test from "node:test";
import type { Plan } from "../../../../hil/service/frontend/src/api/types.ts";
import { againWith, startFrom, withStart } from "../../../../hil/service/frontend/src/views/plans/start-values.ts";
import { changedIn } from "../../../../hil/service/frontend/src/views/plans/typed-values.ts";
import { lineAt } from "../../../../hil/service/frontend/src/editor/lines.ts";
import { nameIn, renamed, START } from "../../../../hil/service/frontend/src/views/plans/plan-text.ts";

test("the name is that which stands at the beginning of a line", () => {
  assert.equal(nameIn(START), "my_plan");
  assert.equal(nameIn('title: x\nname: "a-b.c" # why\n'), "a-b.c");
  for (const text of ["", "name: a b", "steps:\n  name: x\n", "name:\n"]) assert.equal(nameIn(text), null, text);
});

test("a copy has another name and nothing else", () => assert.equal(renamed("name: a\ntitle: a\n", "b"), "name: b\ntitle: a\n"));

test("a line is found by its number, the last one beyond the end", () => {
  const text = "a\nbcd\n\nef";
  assert.deepEqual([1, 2, 3, 4, 9, 0].map((line) => text.slice(...lineAt(text, line))), ["a", "bcd", "", "ef", "ef", "a"]);
});

test("what a run was started with is read from the address of its plan", () => {
  const address = againWith({ plan: "short", bench: "rear axle", values: { torque_nm: 150, slope: -0.5 } });
  assert.equal(address.split("?")[0], "/plans/short");
  assert.deepEqual(startFrom(new URLSearchParams(address.split("?")[1])), { plan: "", bench: "rear axle", values: { torque_nm: "150", slope: "-0.5" } });
  assert.deepEqual(startFrom(new URLSearchParams("value.a=much&b=1")), { plan: "", bench: "", values: {} });
});

test("a start in an address leaves what else stands there, and takes the place of an earlier one", () => {
  const query = new URLSearchParams("t=1..2&plan=long&value.slope=3");
  assert.equal(withStart(query, { plan: "short", bench: "", values: { torque_nm: "20.5" } }).toString(), "t=1..2&plan=short&value.torque_nm=20.5");
  assert.equal(withStart(query, { plan: "", bench: "", values: {} }).toString(), "t=1..2");
});

test("only numbers that are not the plan's own are taken for changed", () => {
  const variable = { default: 100, unit: "N m", description: "", lower: 0, upper: 200 }, plan = { variables: { a: variable, b: variable, c: variable, d: variable } } as unknown as Plan;
  assert.deepEqual(changedIn(plan, { a: "20,5", b: "100.0", c: "" }), { a: "20.5" });
});
