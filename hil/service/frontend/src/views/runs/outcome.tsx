// What stands at the head of a run that is over and did not pass: the reason in a sentence, and its place in the curves.

import type { JSX } from "preact";
import type { Run, RunView } from "../../api/types.ts";
import { English } from "../../i18n/english.tsx";
import { t, tn } from "../../i18n/text.ts";
import { failureOf, inOrder, isFailed, namedBy } from "../criterion-words.ts";
import { look, rangeOfSegment } from "./places.ts";

// Kinds of events that say why a run ended, the first that happened before the others.
const CAUSES = ["limit", "emergency_stop", "failure", "interrupt"];
const BEFORE_S = 2, AFTER_S = 1;

export const isPassed = (run: Run): boolean => run.state === "ended" && (run.verdict === "pass" || run.verdict === "done");

export function Outcome({ run, view }: { run: Run; view: RunView | null }): JSX.Element | null {
  const unsafe = run.safe_state === "not_confirmed";
  if (isPassed(run) && !unsafe) return null;
  const failed = inOrder(view?.criteria ?? []).filter(isFailed), [first] = failed;
  const [reason = "", ...more] = run.reason ? run.reason.split("\n") : [];
  if (!unsafe && !reason && !first) return null;
  const cause = view?.marks.filter((mark) => mark.kind === "event" && CAUSES.includes(mark.name)).sort((one, other) => CAUSES.indexOf(one.name) - CAUSES.indexOf(other.name))[0];
  const segment = first && view ? rangeOfSegment(view, namedBy(first.id).segment) : null;
  return (
    <section class={`banner outcome ${run.state === "cancelled" ? "" : "emergency_stop"}`} aria-label={t("Why it did not pass")}>
      {unsafe ? <p class="lead bad">{t("The bench's safe state is NOT CONFIRMED.")}</p> : null}
      {reason ? <p class="lead"><English>{reason}</English></p> : null}
      {more.map((line) => <p class="quiet" key={line}><English>{line.trim()}</English></p>)}
      {reason && view && cause ? <p><button type="button" class="plain" onClick={() => look({ from: Math.max(view.first_s, cause.start_s - BEFORE_S), to: cause.start_s + AFTER_S })}>{t("Show it in the plots")}</button></p> : null}
      {first ? (
        <p class={reason ? "" : "lead"}>{failureOf(first)}{first.reason ? <> <English>{first.reason}</English></> : null}
          {segment ? <> <button type="button" class="plain" onClick={() => look(segment)}>{t("Show its segment in the plots")}</button></> : null}
        </p>
      ) : null}
      {failed.length > 1 ? <p class="quiet">{tn("{count} more criterion failed.", "{count} more criteria failed.", failed.length - 1)}</p> : null}
    </section>
  );
}
