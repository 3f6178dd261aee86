// The emergency stop: on every page, of the bench in sight, else of all; nobody has to be signed in for it.

import type { JSX } from "preact";
import { useLayoutEffect, useState } from "preact/hooks";
import { stopNow } from "../api/client.ts";
import { attempt } from "../data.ts";
import { t } from "../i18n/text.ts";
import { Store, useStore } from "../store.ts";

// The bench that the view is about; '' for all. It changes with the address only, never because a run ends.
export const benchInSight = new Store("");

// Called by views of one bench: null while it is not known whether the service has the bench, '' where it has none.
export function useStopOf(bench: string, known: boolean | null): void {
  useLayoutEffect(() => {
    if (known !== null) benchInSight.value = known ? bench : "";
    else if (benchInSight.value !== bench) benchInSight.value = "";
  }, [bench, known]);
}

export const stopScope = (bench: string): string => (bench ? t("{bench} only", { bench }) : t("all benches"));

// Whether a stop that was asked for has been taken by nobody for so long that a person must know.
const LATE_MS = 1000;
export const stopUntaken = new Store(false);

export async function pressStop(bench: string): Promise<boolean> {
  const late = setTimeout(() => { stopUntaken.value = true; }, LATE_MS);
  const taken = await attempt(() => stopNow(bench).then(() => true));
  clearTimeout(late);
  stopUntaken.value = !taken;
  return taken === true;
}

export function StopButton(): JSX.Element {
  const bench = useStore(benchInSight), untaken = useStore(stopUntaken);
  const [state, setState] = useState<"" | "sending" | "taken">("");
  const stop = async () => {
    setState("sending");
    setState(await pressStop(bench) ? "taken" : "");
    setTimeout(() => setState((one) => (one === "taken" ? "" : one)), 1500);
  };
  const words = untaken ? t("NOT delivered") : state === "sending" ? t("sending") : state === "taken" ? t("sent") : stopScope(bench);
  return (
    <button type="button" class="stop" onClick={() => void stop()}>
      {t("Emergency stop")} <small>{words}</small>
    </button>
  );
}

export function UntakenStop(): JSX.Element | null {
  const untaken = useStore(stopUntaken);
  return untaken ? <p class="alarm" role="alert">{t("The emergency stop is NOT delivered: the service does not answer. It is tried again for half a minute. Use the stop at the bench.")}</p> : null;
}
