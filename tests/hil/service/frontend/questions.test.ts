// No window of the browser's: while one is open nothing of a page works, the emergency stop least of all.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { agreed, dismiss, question } from "../../../../hil/service/frontend/src/question.ts";

const SOURCES = join(import.meta.dirname, "../../../../hil/service/frontend/src");

test("no source of the page opens a window of the browser's", () => {
  const names = readdirSync(SOURCES, { recursive: true, encoding: "utf8" }).filter((name) => /\.tsx?$/.test(name));
  const opening = names.filter((name) => /(?<![\w.]|function )(?:confirm|alert|prompt)\(|window\.(?:confirm|alert|prompt)/.test(readFileSync(join(SOURCES, name), "utf8")));
  assert.deepEqual(opening, []);
});

test("a later question answers the one before with no", async () => {
  const first = agreed("first?", "yes", "no"), second = agreed("second?", "yes", "no");
  assert.equal(await first, false);
  question.value?.answer(true);
  assert.equal(await second, true);
  assert.equal(question.value, null);
});

test("what is dismissed is not agreed to", async () => {
  const asked = agreed("really?", "yes", "no");
  dismiss();
  assert.equal(await asked, false);
});
