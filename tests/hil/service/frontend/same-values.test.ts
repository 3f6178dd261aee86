// Runs of a plan by the values of its variables: of which a trend is, and of which others there are.

import assert from "node:assert/strict";
import test from "node:test";
import { groupsOf } from "../../../../hil/service/frontend/src/views/trends/by-values.ts";

test("runs are put together by their values, the newest first, with the plan's own where a run set none", () => {
  const runs = [{ id: 1, values: {} }, { id: 2, values: { torque_nm: 50 } }, { id: 3, values: { torque_nm: 100 } }, { id: 4, values: { torque_nm: 50 } }];
  assert.deepEqual(groupsOf(runs, { torque_nm: 100 }), [{ run: 4, values: "torque_nm = 50", count: 2 }, { run: 3, values: "torque_nm = 100", count: 2 }]);
  assert.deepEqual(groupsOf([{ id: 7, values: {} }], {}), [{ run: 7, values: "", count: 1 }]);
});
