import assert from "node:assert/strict";
import { test } from "node:test";
import { t } from "../../../../hil/service/frontend/src/i18n/text.ts";

test("values stand in the place of their braces, and an unknown one stays as it is", () => {
  assert.equal(t("Run {run} of {plan}", { run: 7, plan: "steps" }), "Run 7 of steps");
  assert.equal(t("{nothing} here"), "{nothing} here");
});
