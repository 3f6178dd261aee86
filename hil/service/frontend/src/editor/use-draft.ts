// A value that is typed: restored where it was left unsaved, kept while it is typed, and asked about before leaving.

import { useEffect, useRef, useState } from "preact/hooks";
import { noteUnsaved } from "../leaving.ts";
import { useMe } from "../session.ts";
import { draftKey, forgetDraft, forgetOld, keepDraft, readDraft } from "./drafts.ts";

export interface Drafted<T> {
  value: T;
  set: (value: T) => void;
  restoredAt: string; // when what was restored was typed; '' if nothing was
  discard: () => void; // what was typed, for what there was before
  saved: () => void; // nothing is unsaved any more
}

// `isStart` says of a value that nothing of it would be lost.
export function useDraft<T>(item: string, start: T, isStart: (value: T) => boolean): Drafted<T> {
  const key = draftKey(useMe().name, item), mine = useRef({});
  const [found] = useState(() => { forgetOld(localStorage, new Date()); return readDraft<T>(localStorage, key); });
  const restored = found && !isStart(found.value) ? found : null;
  const [value, setValue] = useState(restored ? restored.value : start), [restoredAt, setRestoredAt] = useState(restored?.at ?? "");
  const note = (next: T) => {
    const unsaved = !isStart(next);
    noteUnsaved(mine.current, unsaved);
    if (unsaved) keepDraft(localStorage, key, next, new Date());
    else forgetDraft(localStorage, key);
  };
  useEffect(() => {
    noteUnsaved(mine.current, !isStart(value));
    return () => noteUnsaved(mine.current, false);
  }, []);
  const set = (next: T) => { setValue(next); note(next); };
  const saved = () => { noteUnsaved(mine.current, false); forgetDraft(localStorage, key); setRestoredAt(""); };
  return { value, set, restoredAt, discard: () => { setValue(start); saved(); }, saved };
}
