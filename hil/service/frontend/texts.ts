// Which texts the page shows, and the catalogues that translate them: `npm run texts` writes what is missing as "".

import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import ts from "typescript";

const HERE = fileURLToPath(new URL(".", import.meta.url));
const SOURCES = join(HERE, "src");
export const CATALOGUES = join(SOURCES, "i18n");

export interface Key {
  text: string;
  plural: boolean;
  where: string;
  unfilled: string[]; // names in braces for which the call gives no value; [] where it gives them by a variable
}

const namesIn = (text: string): string[] => [...new Set([...text.matchAll(/\{(\w+)\}|<(\w+)>/g)].map(([, value, element]) => value ?? element ?? ""))];

function unfilledBy(call: ts.CallExpression, text: string, kind: string): string[] {
  const wanted = namesIn(text).filter((name) => !(kind === "tn" && name === "count")), given = call.arguments[kind === "tn" ? 3 : 1];
  if (kind === "said" || (given && !ts.isObjectLiteralExpression(given)) || given?.properties.some(ts.isSpreadAssignment)) return [];
  const named = (given?.properties ?? []).map((one) => (one.name && (ts.isIdentifier(one.name) || ts.isStringLiteral(one.name)) ? one.name.text : ""));
  return wanted.filter((name) => !named.includes(name));
}

// The first text of t, tx and said, the second of tn; texts that are computed are keys somewhere else as they are.
export function keysIn(name: string, source: string): Key[] {
  const file = ts.createSourceFile(name, source, ts.ScriptTarget.Latest, true, ts.ScriptKind.TSX), keys: Key[] = [];
  const visit = (node: ts.Node): void => {
    if (ts.isCallExpression(node) && ts.isIdentifier(node.expression) && ["t", "tn", "tx", "said"].includes(node.expression.text)) {
      const kind = node.expression.text, plural = kind === "tn", text = node.arguments[plural ? 1 : 0];
      if (text && ts.isStringLiteralLike(text)) keys.push({ text: text.text, plural, where: `${name}:${file.getLineAndCharacterOfPosition(node.getStart()).line + 1}`, unfilled: unfilledBy(node, text.text, kind) });
    }
    ts.forEachChild(node, visit);
  };
  visit(file);
  return keys;
}

export const allKeys = (): Map<string, Key> => new Map(allCalls().map((key) => [key.text, key]));

export function allCalls(): Key[] {
  const names = readdirSync(SOURCES, { recursive: true, encoding: "utf8" }).filter((name) => /\.tsx?$/.test(name) && !name.endsWith(".d.ts")).sort();
  return names.flatMap((name) => keysIn(name, readFileSync(join(SOURCES, name), "utf8")));
}

export type Translation = string | Record<string, string>;

export const languages = (): string[] => readdirSync(CATALOGUES).filter((name) => name.endsWith(".json")).map((name) => name.slice(0, -5)).sort();

export const catalogueOf = (language: string): Record<string, Translation> => JSON.parse(readFileSync(join(CATALOGUES, `${language}.json`), "utf8")) as Record<string, Translation>;

export const formsOf = (language: string): string[] => [...new Intl.PluralRules(language).resolvedOptions().pluralCategories].sort();

// Sorted by their codes, so that two people's additions seldom meet.
export const written = (catalogue: Record<string, Translation>): string =>
  `${JSON.stringify(Object.fromEntries(Object.entries(catalogue).sort(([one], [other]) => (one < other ? -1 : 1))), null, 1)}\n`;

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const keys = allKeys();
  for (const language of languages()) {
    const known = catalogueOf(language), empty = Object.fromEntries(formsOf(language).map((form) => [form, ""]));
    const catalogue = Object.fromEntries([...keys.values()].map(({ text, plural }) => [text, known[text] ?? (plural ? empty : "")]));
    writeFileSync(join(CATALOGUES, `${language}.json`), written(catalogue));
    const missing = Object.values(catalogue).filter((one) => one === "" || (typeof one === "object" && Object.values(one).includes(""))).length;
    console.log(`${language}: ${keys.size} texts, ${missing} without a translation, ${Object.keys(known).filter((text) => !keys.has(text)).length} no longer used and removed`);
  }
}
