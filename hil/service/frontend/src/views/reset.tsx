// The action that resets an emergency stop, with the speed at which the motor turned when it was last measured.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { serviceNowMs } from "../api/clock.ts";
import { get, post } from "../api/client.ts";
import type { Bench, Run } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { t } from "../i18n/text.ts";
import { agreed, dismiss } from "../question.ts";
import { isFreshStandstill, isRecentLook, isSeenTurning, lastSpeedText, resetText } from "./bench-words.ts";
import { useNow } from "./panel-prompt.tsx";

// Where the axle was just seen to turn nobody can say that it stands. Where it was not just seen to stand either, one
// click must not be enough: a recording may end before the axle stands, a service that was started since knows no
// speed, and what was seen a while ago says little of now.
export function Reset({ bench, next }: { bench: Bench; next: Run | null | undefined }): JSX.Element {
  const now = useNow(), said = lastSpeedText(bench, now), turns = bench.last_speed?.turns ?? true, turning = isSeenTurning(bench, now);
  const [looks, setLooks] = useState(false);
  const reset = () => attempt(async () => { if (await mayBeSent(bench, setLooks)) await post(`${pathOf(bench)}/reset`); });
  return (
    <>
      <button type="button" class={turns ? "" : "main"} disabled={looks || turning} onClick={() => void reset()}>{looks ? t("Looking at the speed …") : resetText(next)}</button>
      <span class={turns ? "bad" : "quiet"}>{said}{turning ? ` ${t("Wait until it stands, or brake it: a reset is refused while it turns.")}` : ""}</span>
    </>
  );
}

const pathOf = (bench: Bench): string => `/benches/${encodeURIComponent(bench.name)}`;

// Whether to send it: the axle was seen to stand by the service just now, or by the person who is asked. The window shows each look as it comes; one from before
// the stop says nothing of now, so that the next one is waited for, where the service can look at all.
async function mayBeSent(bench: Bench, setLooks: (looks: boolean) => void): Promise<boolean> {
  if (isFreshStandstill(bench, serviceNowMs()) || isSeenTurning(bench, serviceNowMs())) return true; // of one that turns the service refuses it
  if (!(await agreed(<Asked bench={bench} />, t("It stands still: reset"), t("Cancel")))) return false;
  const now = await get<Bench>(pathOf(bench));
  if (!now.last_speed || isRecentLook(now, serviceNowMs())) return true;
  setLooks(true);
  const newer = await nextLook(now).finally(() => { setLooks(false); });
  return newer ? mayBeSent(newer, setLooks) : true;
}

const LOOK_MS = 7000; // the service looks every 5 s, and needs a second for it
const BETWEEN_MS = 500;

async function nextLook(bench: Bench): Promise<Bench | null> {
  for (const endMs = Date.now() + LOOK_MS; Date.now() < endMs;) {
    await new Promise((resolve) => { setTimeout(resolve, BETWEEN_MS); });
    const now = await get<Bench>(pathOf(bench));
    if (now.last_speed?.at !== bench.last_speed?.at) return now;
  }
  return null;
}

function Asked({ bench }: { bench: Bench }): JSX.Element {
  const now = useData<Bench>(pathOf(bench), 1000).data ?? bench, isReset = now.state !== "emergency_stop";
  useEffect(() => { if (isReset) dismiss(); }, [isReset]); // somebody else has reset it
  return (
    <>
      <p>{lastSpeedText(now, useNow())}</p>
      <p>{t("Does the axle of {bench} stand still now? Reset the emergency stop only if you have seen it.", { bench: bench.name })}</p>
    </>
  );
}
