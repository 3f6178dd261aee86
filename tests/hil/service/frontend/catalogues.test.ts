// Every text of the page is in every catalogue, and nothing else; `npm run texts` writes what is missing.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test from "node:test";
import { LANGUAGES, languageOf, localeOf } from "../../../../hil/service/frontend/src/i18n/language.ts";
import { CATALOGUES, allCalls, allKeys, catalogueOf, formsOf, keysIn, languages, written, type Key, type Translation } from "../../../../hil/service/frontend/texts.ts";

const keys = allKeys();
const bracesOf = (text: string): string[] => [...new Set(text.match(/\{\w+\}|<\/?\w+>/g) ?? [])].sort();
const textsOf = (translation: Translation): string[] => (typeof translation === "string" ? [translation] : Object.values(translation));

function mistakesOf(language: string, { text, plural, where }: Key, translation: Translation | undefined): string[] {
  const place = `${language}: "${text}" (${where})`;
  if (translation === undefined) return [`${place} has no translation`];
  if (plural !== (typeof translation === "object")) return [`${place} ${plural ? "needs a text for each of" : "has no forms"} ${formsOf(language).join(", ")}`];
  if (plural && Object.keys(translation).sort().join() !== formsOf(language).join()) return [`${place} needs the forms ${formsOf(language).join(", ")}`];
  return textsOf(translation).flatMap((one) => {
    if (!one.trim()) return [`${place} is empty`];
    // a form for one may say the number in words
    return bracesOf(one).join() === bracesOf(text).join() || (plural && bracesOf(one).every((brace) => bracesOf(text).includes(brace))) ? [] : [`${place} has other braces: "${one}"`];
  });
}

for (const language of languages()) {
  const catalogue = catalogueOf(language);
  test(`${language} has every text of the page, with its braces`, () => {
    assert.deepEqual([...keys.values()].flatMap((key) => mistakesOf(language, key, catalogue[key.text])), []);
  });
  test(`${language} has no text that the page does not show`, () => assert.deepEqual(Object.keys(catalogue).filter((text) => !keys.has(text)), []));
  test(`${language} is sorted as npm run texts writes it`, () => assert.equal(readFileSync(join(CATALOGUES, `${language}.json`), "utf8"), written(catalogue)));
}

test("each language that can be chosen has a catalogue, and each catalogue can be chosen", () => {
  assert.deepEqual(Object.keys(LANGUAGES).filter((one) => one !== "en").sort(), languages());
});

test("no text begins or ends with a space, as a piece of a sentence does", () => assert.deepEqual([...keys.keys()].filter((text) => text !== text.trim()), []));

test("every name in braces has a value where the text is shown", () => {
  assert.deepEqual(allCalls().filter((one) => one.unfilled.length).map(({ text, where, unfilled }) => `${where}: "${text}" lacks ${unfilled.join(", ")}`), []);
  const found = keysIn("a.tsx", 't("{a} of {b}", { a }); t("{c}"); tx("<d>{e}</d>", { d: link }); tn("{count} run", "{count} runs of {f}", 2); t("{g}", values); t("{h}", { ...values }); said("{i}");');
  assert.deepEqual(found.map(({ unfilled }) => unfilled), [["b"], ["c"], ["e"], ["f"], [], [], []]);
});

test("keys are found in calls and nowhere else", () => {
  const found = keysIn("a.tsx", 'const a = <p title={t("One")}>{tn("{count} run", "{count} runs", 2)} {tx("<a>x</a>", {})} {other("no")} {t(name)}</p>;');
  assert.deepEqual(found.map(({ text, plural }) => [text, plural]), [["One", false], ["{count} runs", true], ["<a>x</a>", false]]);
});

test("a mistake in a catalogue is named with its place", () => {
  const key = { text: "{count} runs of {plan}", plural: false, where: "a.tsx:1", unfilled: [] };
  assert.match(mistakesOf("de", key, "{count} Läufe")[0] ?? "", /a\.tsx:1.*other braces/);
  assert.match(mistakesOf("de", key, "")[0] ?? "", /is empty/);
  assert.match(mistakesOf("de", key, undefined)[0] ?? "", /no translation/);
  assert.match(mistakesOf("de", { ...key, plural: true }, { other: "{count} Läufe" })[0] ?? "", /forms one, other/);
});

// docs/reference/glossary.md: of two words for one thing, the one that left.
const LEFT: Record<string, RegExp> = { de: /[Aa]ngehalten(?!.*SIGSTOP)/, ja: /プラン|保留|セグメント|オペレーター|実行 \{run\}/ };

for (const [language, left] of Object.entries(LEFT)) {
  test(`${language} has one word for one thing`, () => assert.deepEqual(Object.values(catalogueOf(language)).flatMap(textsOf).filter((text) => left.test(text)), []));
}

test("an error and a device's fault have a word each in German, whatever they are an error of", () => {
  const known = catalogueOf("de");
  assert.deepEqual(["error", "failure"].map((text) => known[text]), ["Fehler", "Fehler"]);
  for (const [text, words] of Object.entries(known)) for (const one of textsOf(words)) if (/Störung/.test(one)) assert.match(text, /fault/);
});

test("the language is the one chosen, else the first of the browser's that there is, else English", () => {
  assert.deepEqual([languageOf("ja", ["de-AT"]), languageOf(null, ["fr-CH", "de-CH", "en"]), languageOf("", ["fr"]), languageOf("xx", ["ja-JP"])], ["ja", "de", "en", "ja"]);
  assert.deepEqual([localeOf("de", ["en-US", "de-CH"]), localeOf("ja", ["en-US"])], ["de-CH", "ja"]);
});
