// What may be written at a place of a file, by its schema.

import { placeIn, type Place } from "./place.ts";
import { keysAt, type Schema } from "./schema.ts";

export type FileKind = "toml" | "yaml";

export interface Offer {
  name: string;
  about: string;
  inserted: string; // in place of what was typed
  from: number;
}

const MOST = 40;

export function offersAt(schema: Schema, kind: FileKind, text: string, at: number): Offer[] {
  const place = placeIn(kind, text, at);
  if (!place) return [];
  const keys = keysAt(schema, place.path, place.values);
  const offers = place.of === "value" ? valuesOf(place, keys, kind) : keysFor(place, keys, kind);
  const typed = bareStart(place.typed);
  return offers.filter((one) => one.name.startsWith(typed) && one.name !== typed).slice(0, MOST);
}

const bareStart = (typed: string): string => typed.replace(/^["']/, "");

function valuesOf(place: Place, keys: ReturnType<typeof keysAt>, kind: FileKind): Offer[] {
  const key = keys.find((one) => one.name === place.key);
  const quoted = (value: string) => (kind === "toml" && !/^(true|false|-?\d.*)$/.test(value) ? JSON.stringify(value) : value);
  return (key?.values ?? []).map((value) => ({ name: value, about: "", inserted: quoted(value), from: place.from }));
}

// What has to be there comes first.
function keysFor(place: Place, keys: ReturnType<typeof keysAt>, kind: FileKind): Offer[] {
  const wanted = keys.filter((one) => !place.there.includes(one.name) && (kind === "yaml" || one.isTable === (place.of === "table") || (place.of === "key" && place.path.length > 0)));
  const offered = wanted.sort((one, other) => Number(other.required) - Number(one.required));
  const end = place.of === "table" ? "" : kind === "toml" ? " = " : ": ";
  return offered.map((one) => ({ name: one.name, about: one.about, inserted: one.name + end, from: place.from }));
}
