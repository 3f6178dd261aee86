// Why a form is not sent: in the page's words, whatever language the browser has.

import assert from "node:assert/strict";
import test from "node:test";
import { whyInvalid, type Field } from "../../../../hil/service/frontend/src/ui/why-invalid.ts";

const field = (fault: keyof ValidityState, more: Partial<Field> = {}): Field => ({ validity: { [fault]: true } as unknown as ValidityState, validationMessage: "Dies ist die Sprache des Browsers.", tagName: "INPUT", type: "text", title: "", ...more });

test("each fault has words of the page, and what the page has set itself stays", () => {
  assert.equal(whyInvalid(field("valueMissing")), "This field is empty.");
  assert.equal(whyInvalid(field("valueMissing", { tagName: "SELECT" })), "Choose one of the list.");
  assert.equal(whyInvalid(field("patternMismatch", { title: "letters, digits, _ and -" })), "Allowed are letters, digits, _ and -, and first a letter or a digit.");
  assert.equal(whyInvalid(field("badInput", { type: "date" })), "This is no complete date.");
  assert.equal(whyInvalid(field("rangeUnderflow", { type: "date", min: "2026-11-28" })), "The earliest is Nov 28, 2026.");
  assert.match(whyInvalid(field("rangeOverflow", { type: "datetime-local", max: "2026-11-28T10:30" })), /^The latest is Nov 28, 2026, 10:30/);
  assert.equal(whyInvalid(field("customError", { validationMessage: "It has 70 letters; at most 64 are kept." })), "It has 70 letters; at most 64 are kept.");
});
