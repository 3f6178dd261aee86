// A plan as text: its name, a copy's name, and where a line lies.

import assert from "node:assert/strict";
import test from "node:test";
import { againWith, valuesFrom } from "../../../../hil/service/frontend/src/views/plans/start-values.ts";
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
  assert.deepEqual(valuesFrom(new URLSearchParams(address.split("?")[1])), { bench: "rear axle", values: { torque_nm: "150", slope: "-0.5" } });
  assert.deepEqual(valuesFrom(new URLSearchParams("value.a=much&b=1")), { bench: "", values: {} });
});
