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

test("a run whose end a person wanted has not failed", () => {
  const ended = (reason: string, verdict: Run["verdict"] = "error") => runInWords({ state: "ended", verdict, reason });
  assert.deepEqual([ended("stopped by the operator"), ended("stopped by the operator, who did not continue at 'Is the cage shut?'")], ["ended early", "ended early"]);
  assert.deepEqual([ended("emergency stop: requested by anna on the service's page\n  make sure"), ended("emergency stop: the operator typed e"), ended("stopped before it began: emergency stop since 12:00", null)], ["stopped", "stopped", "stopped"]);
  assert.deepEqual([ended("emergency stop: the door is open"), ended("stopped by the operator, when the process that holds the bench was killed"), ended("operator prompt: no answer to 'ready' within 5 s"), ended("stopped by the operator", "fail")], ["error", "error", "error", "fail"]);
});

test("a run has one word, of its state and its verdict", () => {
  const runs = [["ended", "pass"], ["ended", null], ["interrupted", "error"], ["interrupted", null], ["cancelled", null], ["queued", null]] as [Run["state"], NonNullable<Run["verdict"]> | null][];
  assert.deepEqual(runs.map(([state, verdict]) => runInWords({ state, verdict })), ["pass", "error", "interrupted", "interrupted", "cancelled", "queued"]);
});
