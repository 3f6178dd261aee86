// The action that resets an emergency stop, with the speed at which the motor turned when it was last measured.

import type { JSX } from "preact";
import { post } from "../api/client.ts";
import type { Bench, Run } from "../api/types.ts";
import { attempt } from "../data.ts";
import { t } from "../i18n/text.ts";
import { agreed } from "../question.ts";
import { lastSpeedText, resetText } from "./bench-words.ts";
import { useNow } from "./panel-prompt.tsx";

// A recording may end before the axle stands, and a service that was started since knows no speed: then one click
// must not be enough.
export function Reset({ bench, next }: { bench: Bench; next: Run | null | undefined }): JSX.Element {
  const said = lastSpeedText(bench, useNow()), unsure = bench.last_speed?.turns ?? true;
  const reset = async () => {
    const words = <><p>{said}</p><p>{t("Does the axle of {bench} stand still now? Reset the emergency stop only if you have seen it.", { bench: bench.name })}</p></>;
    if (unsure && !(await agreed(words, t("It stands still: reset"), t("Cancel")))) return;
    void attempt(() => post(`/benches/${encodeURIComponent(bench.name)}/reset`));
  };
  return (
    <>
      <button type="button" class={unsure ? "" : "main"} onClick={() => void reset()}>{resetText(next)}</button>
      <span class={unsure ? "bad" : "quiet"}>{said}</span>
    </>
  );
}
