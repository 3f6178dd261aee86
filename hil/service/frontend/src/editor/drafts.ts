// What somebody types and has not saved, kept in this browser for each person, item and tab: it survives a reload.

export interface Draft<T> {
  at: string; // when it was typed last, ISO 8601
  value: T;
}

const PREFIX = "hil.draft", TAB = "hil.tab";
const KEPT_MS = 60 * 24 * 3_600_000;

// Each tab has its own: what one saves or types takes nothing from another.
export const draftKey = (person: string, item: string, tab: string): string => [PREFIX, person, item, tab].map(encodeURIComponent).join("/");

// Stays while its tab is open, over reloads.
export function tabOf(store: Storage): string {
  try {
    const known = store.getItem(TAB), tab = known ?? Math.random().toString(36).slice(2);
    if (known === null) store.setItem(TAB, tab);
    return tab;
  } catch { // a browser that keeps nothing
    return "";
  }
}

// That of the tab, else the newest of the others, which becomes this tab's: theirs may be closed. One that is open
// keeps its own again when it hears that it is gone.
export function takeDraft<T>(store: Storage, key: string): Draft<T> | null {
  const own = readDraft<T>(store, key);
  if (own) return own;
  const others = keysOf(store).filter((one) => one.startsWith(key.slice(0, key.lastIndexOf("/") + 1)));
  const found = others.map((one) => ({ one, draft: readDraft<T>(store, one) })).sort((a, b) => (b.draft?.at ?? "").localeCompare(a.draft?.at ?? ""))[0];
  if (!found?.draft) return null;
  forgetDraft(store, found.one);
  keepDraft(store, key, found.draft.value, new Date(found.draft.at));
  return found.draft;
}

function keysOf(store: Storage): string[] {
  try {
    return Array.from({ length: store.length }, (_, at) => store.key(at) ?? "");
  } catch {
    return [];
  }
}

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
    const keys = keysOf(store).filter((key) => key.startsWith(`${PREFIX}/`));
    for (const key of keys) {
      const at = Date.parse(readDraft(store, key)?.at ?? "");
      if (!(now.getTime() - at < KEPT_MS)) forgetDraft(store, key);
    }
  } catch { // kept by nobody
  }
}
