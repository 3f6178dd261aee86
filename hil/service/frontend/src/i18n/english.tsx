// What the service says in its own words: in the reader's language where it is known, else read out as the English it is.

import type { ComponentChildren, JSX } from "preact";
import { LANGUAGE } from "./language.ts";
import { withLocalMoments } from "./local-moments.ts";
import { atThePage, linesOf, translated, withoutPlace } from "./phrases.ts";

export function English({ children }: { children: ComponentChildren }): JSX.Element {
  if (typeof children !== "string") return LANGUAGE === "en" ? <>{children}</> : <span lang="en">{children}</span>;
  return <>{linesOf(children).map((line, at) => <Line key={at} of={line} />)}</>;
}

function Line({ of }: { of: string }): JSX.Element {
  if (!of.trim()) return <>{of}</>;
  const line = withoutPlace(of);
  if (LANGUAGE === "en") return <>{atThePage(withLocalMoments(line))}</>;
  const known = translated(line);
  return known === null ? <span lang="en">{withLocalMoments(line)}</span> : <>{withLocalMoments(known)}</>;
}
