// Which entries of the palette have the words that were typed, the nearest first.

export interface Entry {
  kind: string;
  name: string;
  about: string; // in the reader's language, as the name is
  also?: string; // the name in English: who knows that finds it, too
  byName?: string; // found only by words of this, long enough that nobody types them for something else
  path?: string;
  act?: () => void;
}

export function found(entries: Entry[], text: string, most: number): Entry[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const ranked = entries.map((entry, place) => ({ entry, place, rank: rankOf(entry, words) })).filter(({ rank }) => rank !== null) as { entry: Entry; place: number; rank: number }[];
  ranked.sort((one, other) => one.rank - other.rank || one.place - other.place);
  return ranked.slice(0, most).map(({ entry }) => entry);
}

// -1 where a name is what was typed, 0 where it begins with every word; more the farther inside they stand;
// null where one is missing.
function rankOf(entry: Entry, words: string[]): number | null {
  if (entry.byName !== undefined && !isNamed(entry.byName.toLowerCase(), words)) return null;
  const name = entry.name.toLowerCase(), all = `${name} ${entry.about} ${entry.kind} ${entry.also ?? ""}`.toLowerCase();
  let rank = name === words.join(" ") ? -1 : 0;
  for (const word of words) {
    if (name.startsWith(word)) continue;
    if (beginsAWord(name, word)) rank += 1;
    else if (name.includes(word)) rank += 2;
    else if (beginsAWord(all, word)) rank += 3;
    else if (all.includes(word)) rank += 4;
    else return null;
  }
  return rank;
}

const LEAST_LETTERS = 4, LEAST_SIGNS = 2; // "stop", "emer"; in Japanese two signs are a word

const isNamed = (names: string, words: string[]): boolean =>
  words.length > 0 && words.every((word) => beginsAWord(names, word) || names.split(" ").some((one) => one.startsWith(word))) && words.some((word) => word.length >= (/^[\x20-\u024f]+$/.test(word) ? LEAST_LETTERS : LEAST_SIGNS));

const beginsAWord = (text: string, word: string): boolean => text.split(/[\s_.\-,]+/).some((one) => one.startsWith(word));
