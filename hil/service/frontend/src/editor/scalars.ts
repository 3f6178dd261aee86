// Numbers, words and switches of a TOML file, each with its place in the text and what its schema says.

import { placeIn } from "./place.ts";
import { keysAt, type Key, type Schema } from "./schema.ts";

export interface Scalar {
  table: string;
  key: Key;
  value: string; // as it is written
  start: number;
  end: number;
}

const PAIR = /^(\s*([A-Za-z0-9_-]+)\s*=\s*)([-+]?[0-9][0-9_.eE+-]*|true|false|"[^"\\]*")\s*(#.*)?$/;

export function scalarsOf(schema: Schema, text: string): Scalar[] {
  const found: Scalar[] = [];
  let at = 0;
  for (const line of text.split("\n")) {
    const pair = PAIR.exec(line), place = pair && placeIn("toml", text, at + pair[1]!.length - 1);
    if (pair && place) {
      const key = keysAt(schema, place.path, place.values).find((one) => one.name === pair[2]);
      if (key) found.push({ table: place.path.filter((part) => part !== "*").join("."), key, value: pair[3]!, start: at + pair[1]!.length, end: at + pair[1]!.length + pair[3]!.length });
    }
    at += line.length + 1;
  }
  return found;
}

export const isNumber = (scalar: Scalar): boolean => /^[-+]?[0-9]/.test(scalar.value);

// The text with another value there; what it is not decides its quotation marks.
export function changed(text: string, scalar: Scalar, value: string): string {
  const written = scalar.value.startsWith('"') ? JSON.stringify(value) : value;
  return text.slice(0, scalar.start) + written + text.slice(scalar.end);
}
