// Says that a text was restored that had been left unsaved, and how to be rid of it.

import type { JSX } from "preact";
import { moment } from "../format.ts";
import { t } from "../i18n/text.ts";

interface Options {
  of: { restoredAt: string; discard: () => void };
  changed?: boolean; // what it was made from is not what the service has now
}

export function DraftNotice({ of, changed = false }: Options): JSX.Element | null {
  if (!of.restoredAt) return null;
  const discard = () => { if (confirm(t("Discard what you typed? It cannot be brought back."))) of.discard(); };
  return (
    <div class="notice" role="status">
      <p>{t("What you typed and did not save is restored, as of {moment}.", { moment: moment(of.restoredAt) })}{changed ? ` ${t("The text at the service has changed since; the difference is shown when you save.")}` : null}</p>
      <div class="row level"><button type="button" onClick={discard}>{t("Discard it")}</button></div>
    </div>
  );
}
