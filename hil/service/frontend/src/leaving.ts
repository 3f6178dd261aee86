// Whether somebody is asked before the page shows something else: while what they typed is not saved.

import { t } from "./i18n/text.ts";
import { agreed } from "./question.ts";

const unsaved = new Set<object>();

// Of the part of the page that has it.
export function noteUnsaved(of: object, is: boolean): void {
  if (is) unsaved.add(of);
  else unsaved.delete(of);
}

export const isAllSaved = (): boolean => unsaved.size === 0;

// Views inside the page.
export const agreedToLeave = (): Promise<boolean> =>
  agreed(t("What you typed is not saved at the service. Leave it? A draft of it stays in this browser."), t("Leave it"), t("Stay here"));

// Other pages, and this one loaded anew: there the browser asks in its own words, and no page can.
addEventListener("beforeunload", (event) => { if (unsaved.size) event.preventDefault(); });
