// The action that resets an emergency stop, with the speed at which the motor turned when it was last measured.

import type { JSX } from "preact";
import { serviceNowMs } from "../api/clock.ts";
import { get, post } from "../api/client.ts";
import type { Bench, Run } from "../api/types.ts";
import { attempt } from "../data.ts";
import { t } from "../i18n/text.ts";
import { agreed } from "../question.ts";
import { isFreshStandstill, isNewerLook, lastSpeedText, resetText } from "./bench-words.ts";
import { useNow } from "./panel-prompt.tsx";

// Unless it was just seen to stand, one click must not be enough: a recording may end before the axle stands, a
// service that was started since knows no speed, and what was seen a while ago says little of now.
export function Reset({ bench, next }: { bench: Bench; next: Run | null | undefined }): JSX.Element {
  const said = lastSpeedText(bench, useNow()), turns = bench.last_speed?.turns ?? true;
  const reset = () => attempt(async () => { if (await isSeenToStand(bench)) await post(`${pathOf(bench)}/reset`); });
  return (
    <>
      <button type="button" class={turns ? "" : "main"} onClick={() => void reset()}>{resetText(next)}</button>
      <span class={turns ? "bad" : "quiet"}>{said}</span>
    </>
  );
}

const pathOf = (bench: Bench): string => `/benches/${encodeURIComponent(bench.name)}`;

// By the service just now, or by the person who is asked: with the newest speed that the service has, so again where
// there has been a newer one since.
async function isSeenToStand(bench: Bench): Promise<boolean> {
  if (isFreshStandstill(bench, serviceNowMs())) return true;
  if (!(await agreed(<Asked bench={bench} />, t("It stands still: reset"), t("Cancel")))) return false;
  const now = await get<Bench>(pathOf(bench));
  return isNewerLook(bench, now, serviceNowMs()) ? isSeenToStand(now) : true;
}

function Asked({ bench }: { bench: Bench }): JSX.Element {
  return (
    <>
      <p>{lastSpeedText(bench, useNow())}</p>
      <p>{t("Does the axle of {bench} stand still now? Reset the emergency stop only if you have seen it.", { bench: bench.name })}</p>
    </>
  );
}
