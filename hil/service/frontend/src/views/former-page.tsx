// What is still done on the former page, until this one has it.

import type { JSX } from "preact";
import type { Role } from "../api/types.ts";
import { useMay } from "../session.ts";

export function FormerPage({ what, role }: { what: string; role: Role }): JSX.Element | null {
  return useMay()(role) ? <p><a href="/" target="_blank" rel="noopener">{`${what} (on the former page)`}</a></p> : null;
}
