// Where in a file somebody writes: the way to it, what stands beside it, and what has been typed there.

import { ITEM } from "./schema.ts";

export interface Place {
  path: string[];
  values: Record<string, string>[]; // scalars on the way, by depth
  there: string[]; // keys that stand there already
  of: "key" | "value" | "table"; // a table is one in [brackets]
  key: string; // of a value
  typed: string;
  from: number; // where what was typed begins
}

const NAME = "[A-Za-z0-9_.-]";
const bare = (text: string): string => text.replace(/^(["'])(.*)\1$/, "$2");

export function placeIn(kind: "toml" | "yaml", text: string, at: number): Place | null {
  return kind === "toml" ? inToml(text, at) : inYaml(text, at);
}

function inToml(text: string, at: number): Place | null {
  const start = text.lastIndexOf("\n", at - 1) + 1, line = text.slice(start, at);
  const header = /^\s*\[{1,2}([A-Za-z0-9_.-]*)$/.exec(line);
  const tables = tablesIn(text), mine = tables.findLast((one) => one.from <= start) ?? tables[0]!;
  if (header) {
    const parts = header[1]!.split("."), typed = parts.pop()!;
    return { path: parts, values: [tables[0]!.values], there: [], of: "table", key: "", typed, from: at - typed.length };
  }
  const values = mine.path.map((): Record<string, string> => ({}));
  values[mine.path.length] = mine.values;
  values[0] = tables[0]!.values;
  return onLine(line, at, "=", { path: mine.path, values, there: mine.keys });
}

interface Table {
  from: number;
  path: string[];
  values: Record<string, string>;
  keys: string[];
}

function tablesIn(text: string): Table[] {
  const found: Table[] = [{ from: 0, path: [], values: {}, keys: [] }];
  let at = 0;
  for (const line of text.split("\n")) {
    const header = /^\s*(\[{1,2})([^\][]+)\]{1,2}\s*(#.*)?$/.exec(line), pair = /^\s*([A-Za-z0-9_-]+)\s*=\s*(.*)$/.exec(line);
    if (header) {
      const path = header[2]!.split(".").map((part) => bare(part.trim()));
      found.push({ from: at, path: header[1] === "[[" ? [...path, ITEM] : path, values: {}, keys: [] });
    } else if (pair) {
      const last = found.at(-1)!;
      last.keys.push(pair[1]!);
      last.values[pair[1]!] = bare(pair[2]!.replace(/\s*#.*$/, ""));
    }
    at += line.length + 1;
  }
  return found;
}

function inYaml(text: string, at: number): Place | null {
  const start = text.lastIndexOf("\n", at - 1) + 1, stack: { indent: number; key: string }[] = [];
  let lines = text.slice(0, start).split("\n").slice(0, -1);
  lines = [...lines.filter((line) => line.trim() && !line.trim().startsWith("#")), text.slice(start, at)];
  let rest = "";
  const keys = new Map<string, string[]>();
  for (const line of lines) {
    let indent = line.length - line.trimStart().length;
    rest = line.trimStart();
    while (stack.length && stack.at(-1)!.indent >= indent && !(rest.startsWith("-") && stack.at(-1)!.indent === indent && stack.at(-1)!.key !== ITEM)) stack.pop();
    while (/^-(\s|$)/.test(rest)) {
      stack.push({ indent, key: ITEM });
      const skipped = rest.length - rest.slice(1).trimStart().length;
      indent += skipped;
      rest = rest.slice(skipped);
    }
    const opened = /^([A-Za-z0-9_.-]+):\s*(#.*)?$/.exec(rest), way = JSON.stringify(stack.map((one) => one.key));
    const key = /^([A-Za-z0-9_.-]+):/.exec(rest)?.[1];
    if (key && line !== lines.at(-1)) keys.set(way, [...(keys.get(way) ?? []), key]);
    if (opened && line !== lines.at(-1)) stack.push({ indent, key: opened[1]! });
  }
  const path = stack.map((one) => one.key);
  const isNewItem = /^\s*-/.test(lines.at(-1)!);
  return onLine(rest, at, ":", { path, values: [], there: isNewItem ? [] : keys.get(JSON.stringify(path)) ?? [] });
}

// What is typed at the end of a line: a key, a value, or one of both inside of braces.
function onLine(line: string, at: number, separator: "=" | ":", { path, values, there }: Pick<Place, "path" | "values" | "there">): Place | null {
  if (line.includes("#")) return null;
  const braces = new RegExp(`^\\s*(${NAME}+)\\s*${separator}\\s*\\{([^}]*)$`).exec(line) ?? /^\s*()\{([^}]*)$/.exec(line);
  if (braces) {
    const inner = braces[2]!, pairs = [...inner.matchAll(new RegExp(`(${NAME}+)\\s*${separator}\\s*([^,]*)`, "g"))];
    const deeper = braces[1] ? [...path, braces[1]] : path, further = [...values];
    further[deeper.length] = Object.fromEntries(pairs.map(([, key, value]) => [key!, bare(value!.trim())]));
    return onLine(inner.slice(inner.lastIndexOf(",") + 1), at, separator, { path: deeper, values: further, there: pairs.map(([, key]) => key!) });
  }
  const value = new RegExp(`^\\s*(${NAME}+)\\s*${separator}\\s*(["']?)([\\w.-]*)$`).exec(line);
  if (value) return { path, values, there, of: "value", key: value[1]!, typed: value[2]! + value[3]!, from: at - value[2]!.length - value[3]!.length };
  const key = new RegExp(`^\\s*(${NAME}*)$`).exec(line);
  return key ? { path, values, there, of: "key", key: "", typed: key[1]!, from: at - key[1]!.length } : null;
}
