// Words and numbers of diagnoses, and the runs that an address names.

import assert from "node:assert/strict";
import test from "node:test";
import { runsFrom } from "../../../../hil/service/frontend/src/views/studies/chosen-runs.ts";
import { isImproved } from "../../../../hil/service/frontend/src/views/studies/improved.ts";
import { heatOf, percentOf, planNameOf, significant, worstOf } from "../../../../hil/service/frontend/src/views/studies/wording.ts";

test("runs of an address are numbers, each once", () => assert.deepEqual(runsFrom("3,3,x,0,-1,12,1.5"), [3, 12]));

test("figures have as many digits as mean something", () => {
  assert.deepEqual([significant(-0.0123456, 2), percentOf(0.12), percentOf(0.011)], ["−0.012", "12 %", "1.1 %"]);
});

test("the map shows the worst recording, coloured by the logarithm from noise to a hundred times as much", () => {
  const table = [[[40, null]], [[60, null]]];
  assert.deepEqual([worstOf(table, 0, 0), worstOf(table, 0, 1)], [60, null]);
  assert.deepEqual([null, 0.5, 1, 10, 100, 1e6].map(heatOf), [0, 0, 0, 18, 35, 35]);
});

test("a plan is filed under the name that it says, and one that says none is refused", () => {
  assert.equal(planNameOf('title: x\nname: "separate_it"\n'), "separate_it");
  assert.throws(() => planNameOf("title: x\n"), /no name/);
});

test("a model is improved where an effect was named or a gap is smaller, by runs that were held out if there are any", () => {
  const of = (gaps: [number, number][], held: [number, number][] = [], effects: object[] = []) => {
    const table = (all: [number, number][]) => Object.fromEntries(all.map(([before, after], at) => [`channel_${at}`, { before, after, noise_floor: 0.001 }]));
    return isImproved({ effects, gap: table(gaps), holdout_gap: table(held) } as unknown as Parameters<typeof isImproved>[0]);
  };
  assert.equal(of([[0.000716, 0.000718], [0.00692, 0.00694]]), false);
  assert.equal(of([[0.00716, 0.00716]]), false);
  assert.equal(of([[0.00716, 0.0052], [0.00692, 0.00694]]), true);
  assert.equal(of([[0.00716, 0.0052]], [[0.0071, 0.0073]]), false);
  assert.equal(of([[0.00716, 0.00718]], [], [{}]), true);
});
