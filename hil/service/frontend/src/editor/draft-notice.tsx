// Says that a text was restored that had been left unsaved, and how to be rid of it.

import type { JSX } from "preact";
import { moment } from "../format.ts";
import { t } from "../i18n/text.ts";
import { agreed } from "../question.ts";

// Words of a browser alone are lost for good.
export const agreedToDiscard = (): Promise<boolean> => agreed(t("Discard what you typed? It cannot be brought back."), t("Discard it"), t("Write on"));

interface Options {
  of: { restoredAt: string; discard: () => void };
  changed?: boolean; // what it was made from is not what the service has now
}

export function DraftNotice({ of, changed = false }: Options): JSX.Element | null {
  if (!of.restoredAt) return null;
  const discard = async () => { if (await agreedToDiscard()) of.discard(); };
  return (
    <div class="notice" role="status">
      <p>{t("What you typed and did not save is restored, as of {moment}.", { moment: moment(of.restoredAt) })}{changed ? ` ${t("The text at the service has changed since; the difference is shown when you save.")}` : null}</p>
      <div class="row level"><button type="button" onClick={() => void discard()}>{t("Discard it")}</button></div>
    </div>
  );
}
