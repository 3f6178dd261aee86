// A JSON schema as somebody writes by it: which keys may stand at a place, and which values.

export type Schema = { [key: string]: unknown };

export interface Key {
  name: string;
  about: string; // with the unit, as the schema has it
  required: boolean;
  values: string[]; // if only some may stand
  lower: number | null;
  upper: number | null;
  isTable: boolean;
}

export const ITEM = "*"; // the way into a list
type Values = Record<string, string>;

// `values` are the scalars that stand on the way, by depth: which of several forms is meant hangs on them.
export function keysAt(root: Schema, path: string[], values: Values[]): Key[] {
  const nodes = path.reduce((found, part, depth) => found.flatMap((node) => into(root, node, part, values[depth] ?? {})), [root]);
  const last = values[path.length] ?? {}, keys = new Map<string, Key>();
  for (const node of nodes.flatMap((one) => forms(root, one, last))) {
    const required = (node.required ?? []) as string[];
    for (const [name, of] of Object.entries((node.properties ?? {}) as Record<string, Schema | false>)) {
      if (of === false) continue;
      const key = described(root, name, of, required.includes(name)), known = keys.get(name);
      keys.set(name, known ? merged(known, key) : key);
    }
  }
  return [...keys.values()];
}

function into(root: Schema, node: Schema, part: string, values: Values): Schema[] {
  return forms(root, node, values).flatMap((one): Schema[] => {
    const properties = (one.properties ?? {}) as Record<string, unknown>;
    const found = part === ITEM ? one.items : part in properties ? properties[part] : one.additionalProperties;
    return typeof found === "object" && found !== null ? [found as Schema] : [];
  });
}

// A node and all of its alternatives that may be meant.
function forms(root: Schema, node: Schema, values: Values): Schema[] {
  const followed = typeof node.$ref === "string" ? { ...target(root, node.$ref), ...node, $ref: undefined } : node;
  const further = ["allOf", "anyOf", "oneOf"].flatMap((name) => (followed[name] ?? []) as Schema[]);
  if (followed.then && isMeant(followed, values)) further.push(followed.then as Schema);
  return [followed, ...further.flatMap((one) => forms(root, one, values))];
}

// What has to be chosen first is not offered as if all were meant.
function isMeant(node: Schema, values: Values): boolean {
  const condition = node.if as { properties?: Record<string, { const?: unknown }>; required?: string[] } | undefined;
  const then = (node.then as { properties?: Record<string, { default?: unknown }> }).properties ?? {};
  return Object.entries(condition?.properties ?? {}).every(([name, { const: wanted }]) =>
    name in values ? values[name] === String(wanted) : !condition?.required?.includes(name) && then[name]?.default === wanted);
}

function target(root: Schema, ref: string): Schema {
  return ref.replace(/^#\//, "").split("/").reduce((node, part) => (node[part.replaceAll("~1", "/").replaceAll("~0", "~")] ?? {}) as Schema, root);
}

function described(root: Schema, name: string, of: Schema, required: boolean): Key {
  const all = forms(root, of, {}), first = <T>(key: string, kind: string): T | null => (all.find((one) => typeof one[key] === kind)?.[key] ?? null) as T | null;
  const values = all.flatMap((one) => (Array.isArray(one.enum) ? one.enum : one.const !== undefined ? [one.const] : one.type === "boolean" ? [true, false] : []));
  return {
    name, required, about: first<string>("description", "string") ?? "", values: [...new Set(values.map(String))].filter(Boolean),
    lower: first<number>("minimum", "number"), upper: first<number>("maximum", "number"),
    isTable: all.some((one) => one.type === "object" || (one.type === "array" && (one.items as Schema | undefined)?.type === "object")),
  };
}

// Of a key that several forms have, all that any of them says.
const merged = (one: Key, other: Key): Key => ({
  ...one, about: one.about || other.about, required: one.required || other.required, values: one.values.length ? one.values : other.values,
  lower: one.lower ?? other.lower, upper: one.upper ?? other.upper, isTable: one.isTable || other.isTable,
});
