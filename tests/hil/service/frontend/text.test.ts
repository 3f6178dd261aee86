// Texts with values, with numbers that decide a word's form, and with elements in them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { pieces, pluralOf, t, tn } from "../../../../hil/service/frontend/src/i18n/text.ts";

test("values stand in the place of their braces, and an unknown one stays as it is", () => {
  assert.equal(t("Run {run} of {plan}", { run: 7, plan: "steps" }), "Run 7 of steps");
  assert.equal(t("{nothing} here"), "{nothing} here");
});

test("a value that the service did not say is a dash, never the braces", () => {
  const unsaid = { seconds: undefined as unknown as number };
  assert.equal(t("About {seconds} s of bench time.", unsaid), "About – s of bench time.");
  assert.deepEqual(pieces("until {end}", { end: null }), ["until ", "–"]);
});

test("a number decides the form of the word, in English and by the categories of a catalogue's language", () => {
  assert.deepEqual([0, 1, 1200].map((count) => tn("{count} run", "{count} runs", count)), ["0 runs", "1 run", "1,200 runs"]);
  const catalogue = { "{count} runs": { one: "{count} běh", few: "{count} běhy", many: "{count} běhu", other: "{count} běhů" } };
  assert.deepEqual([1, 2, 5].map((count) => pluralOf(catalogue, "cs", "{count} run", "{count} runs", count)), ["{count} běh", "{count} běhy", "{count} běhů"]);
});

test("elements stand in a sentence as it is, or are made around its words", () => {
  assert.deepEqual(pieces("In the <a>table</a> see {code}.", { a: (words) => ["link", words], code: 17 }), ["In the ", ["link", "table"], " see ", 17, "."]);
  assert.deepEqual(pieces("<a>Run {run}</a>", { a: (words) => words, run: 7 }), [["Run ", 7]]);
  assert.deepEqual(pieces("no {value} of this", {}), ["no ", "{value}", " of this"]);
});
