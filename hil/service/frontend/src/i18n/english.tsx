// What the service says in its own words: in the reader's language where it is known, else read out as the English it is.

import type { ComponentChildren, JSX } from "preact";
import { LANGUAGE } from "./language.ts";
import { withLocalMoments } from "./local-moments.ts";
import { linesOf, pausedInWords, translated } from "./phrases.ts";

export function English({ children }: { children: ComponentChildren }): JSX.Element {
  if (typeof children !== "string") return LANGUAGE === "en" ? <>{children}</> : <span lang="en">{children}</span>;
  return <>{linesOf(children).map((line, at) => <Line key={at} of={line} />)}</>;
}

function Line({ of }: { of: string }): JSX.Element {
  if (!of.trim()) return <>{of}</>;
  if (LANGUAGE === "en") return <>{pausedInWords(withLocalMoments(of))}</>;
  const known = translated(of);
  return known === null ? <span lang="en">{withLocalMoments(of)}</span> : <>{withLocalMoments(known)}</>;
}
