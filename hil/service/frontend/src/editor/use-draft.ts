// A value that is typed: restored where it was left unsaved, kept while it is typed, and asked about before leaving.

import { useEffect, useRef, useState } from "preact/hooks";
import { noteUnsaved } from "../leaving.ts";
import { useMe } from "../session.ts";
import { draftKey, forgetDraft, forgetOld, keepDraft, tabOf, takeDraft } from "./drafts.ts";

export interface Drafted<T> {
  value: T;
  set: (value: T) => void;
  restoredAt: string; // when what was restored was typed; '' if nothing was
  discard: () => void; // what was typed, for what there was before
  saved: () => void; // nothing is unsaved any more
}

// `isStart` says of a value that nothing of it would be lost.
export function useDraft<T>(item: string, start: T, isStart: (value: T) => boolean): Drafted<T> {
  const key = draftKey(useMe().name, item, tabOf(sessionStorage)), mine = useRef({});
  const [found] = useState(() => { forgetOld(localStorage, new Date()); return takeDraft<T>(localStorage, key); });
  const restored = found && !isStart(found.value) ? found : null;
  const [value, setValue] = useState(restored ? restored.value : start), [restoredAt, setRestoredAt] = useState(restored?.at ?? "");
  const unsaved = useRef(restored !== null);
  const note = (next: T) => {
    unsaved.current = !isStart(next);
    noteUnsaved(mine.current, unsaved.current);
    if (unsaved.current) keepDraft(localStorage, key, next, new Date());
    else forgetDraft(localStorage, key);
  };
  useEffect(() => {
    noteUnsaved(mine.current, !isStart(value));
    return () => noteUnsaved(mine.current, false);
  }, []);
  const shown = useRef(value);
  shown.current = value;
  useEffect(() => {
    const keepAgain = (event: StorageEvent) => { // another tab has taken it over
      if (event.key === key && event.newValue === null && unsaved.current) keepDraft(localStorage, key, shown.current, new Date());
    };
    addEventListener("storage", keepAgain);
    return () => removeEventListener("storage", keepAgain);
  }, [key]);
  const set = (next: T) => { setValue(next); note(next); };
  const saved = () => { unsaved.current = false; noteUnsaved(mine.current, false); forgetDraft(localStorage, key); setRestoredAt(""); };
  return { value, set, restoredAt, discard: () => { setValue(start); saved(); }, saved };
}
