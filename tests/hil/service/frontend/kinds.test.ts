// Every state, verdict, role and kind of the API has words on the page.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import type { Run } from "../../../../hil/service/frontend/src/api/types.ts";
import { runInWords } from "../../../../hil/service/frontend/src/ui/run-kind.ts";
import { fileURLToPath } from "node:url";
import { isKind, kindInWords } from "../../../../hil/service/frontend/src/ui/kinds.ts";

const NAMED = ["state", "verdict", "role", "kind"];
const ELSEWHERE = ["Order"]; // to agents, and on no page
type Schema = { enum?: string[]; anyOf?: Schema[]; items?: Schema };

const enumsOf = (schema: Schema): string[] => [...(schema.enum ?? []), ...(schema.anyOf ?? []).flatMap(enumsOf), ...(schema.items ? enumsOf(schema.items) : [])];

test("each of the API's states, verdicts, roles and kinds has words", () => {
  const api = JSON.parse(readFileSync(fileURLToPath(new URL("../../../../docs/reference/openapi.json", import.meta.url)), "utf8")) as { components: { schemas: Record<string, { properties?: Record<string, Schema> }> } };
  const names = new Set(Object.entries(api.components.schemas).filter(([name]) => !ELSEWHERE.includes(name)).flatMap(([, { properties }]) => Object.entries(properties ?? {}).filter(([name]) => NAMED.includes(name)).flatMap(([, one]) => enumsOf(one))));
  assert.ok(names.size > 25, [...names].join());
  assert.deepEqual([...names].filter((name) => !isKind(name)), []);
});

test("a name that is not known is shown as it is, in words", () => assert.equal(kindInWords("some_thing"), "some thing"));

test("a run has one word, of its state and its verdict", () => {
  const runs = [["ended", "pass"], ["ended", null], ["interrupted", "error"], ["interrupted", null], ["cancelled", null], ["queued", null]] as [Run["state"], NonNullable<Run["verdict"]> | null][];
  assert.deepEqual(runs.map(([state, verdict]) => runInWords({ state, verdict })), ["pass", "error", "interrupted", "interrupted", "cancelled", "queued"]);
});
