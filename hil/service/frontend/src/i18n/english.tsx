// What the service says in its own words: in the reader's language where it is known, else read out as the English it is.

import type { ComponentChildren, JSX } from "preact";
import { LANGUAGE } from "./language.ts";
import { translated } from "./phrases.ts";

export function English({ children }: { children: ComponentChildren }): JSX.Element {
  if (LANGUAGE === "en") return <>{children}</>;
  const known = typeof children === "string" ? translated(children) : null;
  return known === null ? <span lang="en">{children}</span> : <>{known}</>;
}
