// What the service says in its own words: in the reader's language where it is known, else read out as the English it is.

import type { ComponentChildren, JSX } from "preact";
import { LANGUAGE } from "./language.ts";
import { withLocalMoments } from "./local-moments.ts";
import { pausedInWords, translated } from "./phrases.ts";

export function English({ children }: { children: ComponentChildren }): JSX.Element {
  const said = typeof children === "string" ? children : null;
  const shown = said === null ? children : withLocalMoments(said);
  if (LANGUAGE === "en") return <>{typeof shown === "string" ? pausedInWords(shown) : shown}</>;
  const known = said === null ? null : translated(said);
  return known === null ? <span lang="en">{shown}</span> : <>{withLocalMoments(known)}</>;
}
