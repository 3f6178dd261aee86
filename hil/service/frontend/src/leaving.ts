// Whether somebody is asked before the page shows something else: while what they typed is not saved.

import { t } from "./i18n/text.ts";

const unsaved = new Set<object>();

// Of the part of the page that has it.
export function noteUnsaved(of: object, is: boolean): void {
  if (is) unsaved.add(of);
  else unsaved.delete(of);
}

// Views inside the page.
export const mayLeave = (): boolean => unsaved.size === 0 || confirm(t("What you typed is not saved at the service. Leave it? A draft of it stays in this browser."));

// Other pages, and this one loaded anew: the browser asks in its own words.
addEventListener("beforeunload", (event) => { if (unsaved.size) event.preventDefault(); });
