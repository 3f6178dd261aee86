// What somebody types and has not saved, kept in this browser for each person and item: it survives a reload.

export interface Draft<T> {
  at: string; // when it was typed last, ISO 8601
  value: T;
}

const PREFIX = "hil.draft";
const KEPT_MS = 60 * 24 * 3_600_000;

export const draftKey = (person: string, item: string): string => [PREFIX, person, item].map(encodeURIComponent).join("/");

export function readDraft<T>(store: Storage, key: string): Draft<T> | null {
  try {
    const found = JSON.parse(store.getItem(key) ?? "null") as Draft<T> | null;
    return found && typeof found.at === "string" && found.value !== undefined ? found : null;
  } catch { // not written by this page
    return null;
  }
}

// A text that is written on from: today's, or that of a version.
export const itemOf = (kind: string, name: string, version: number | null): string => (version === null ? `${kind}/${name}` : `${kind}/${name}/${version}`);

// A browser that keeps nothing, or has no room, goes without: leaving is asked about all the same.
export function keepDraft<T>(store: Storage, key: string, value: T, now: Date): void {
  try {
    store.setItem(key, JSON.stringify({ at: now.toISOString(), value } satisfies Draft<T>));
  } catch { // full
    forgetDraft(store, key); // an earlier text is not what was typed last
  }
}

export function forgetDraft(store: Storage, key: string): void {
  try {
    store.removeItem(key);
  } catch { // kept by nobody
  }
}

// Those that were forgotten about, whoever's they are.
export function forgetOld(store: Storage, now: Date): void {
  try {
    const keys = Array.from({ length: store.length }, (_, at) => store.key(at) ?? "").filter((key) => key.startsWith(`${PREFIX}/`));
    for (const key of keys) {
      const at = Date.parse(readDraft(store, key)?.at ?? "");
      if (!(now.getTime() - at < KEPT_MS)) forgetDraft(store, key);
    }
  } catch { // kept by nobody
  }
}
