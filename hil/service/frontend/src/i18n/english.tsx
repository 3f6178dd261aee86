// What the service says in its own words, which are English: read out as such in any language.

import type { ComponentChildren, JSX } from "preact";
import { LANGUAGE } from "./language.ts";

export const English = ({ children }: { children: ComponentChildren }): JSX.Element =>
  LANGUAGE === "en" ? <>{children}</> : <span lang="en">{children}</span>;
