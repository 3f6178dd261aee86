// The emergency stop: on every page, of the bench in sight, else of all; nobody has to be signed in for it.

import type { JSX } from "preact";
import { useLayoutEffect, useState } from "preact/hooks";
import { Refused, STOP_MS, stopNow } from "../api/client.ts";
import { clockTime } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { dismiss } from "../question.ts";
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

// What a person must know of a stop that was asked for: it is not taken and still being tried, it was refused, or it
// was given up; or the stop post has taken it and the service, whose states the page shows, does not answer.
interface Trouble {
  state: "tried" | "refused" | "given up" | "taken alone";
  atMs: number; // when it ends to be tried, has ended, or was taken
  refused: Refused | null;
}

const LATE_MS = 1000;
const stopTrouble = new Store<Trouble | null>(null);

let pressed = 0; // an earlier stop that ends late says nothing of the newest

export async function pressStop(bench: string): Promise<boolean> {
  dismiss(); // what was asked before a stop is asked anew after it
  const mine = ++pressed, untilMs = Date.now() + STOP_MS;
  const put = (trouble: Trouble | null) => { if (mine === pressed) stopTrouble.value = trouble; };
  const late = setTimeout(() => put({ state: "tried", atMs: untilMs, refused: null }), LATE_MS);
  try {
    const { service } = await stopNow(bench), takenMs = Date.now();
    put(null);
    const silent = setTimeout(() => put({ state: "taken alone", atMs: takenMs, refused: null }), LATE_MS);
    const answered = () => { clearTimeout(silent); put(null); };
    service.then(answered, answered);
    return true;
  } catch (error) {
    put(error instanceof Refused ? { state: "refused", atMs: Date.now(), refused: error } : { state: "given up", atMs: Date.now(), refused: null });
    return false;
  } finally {
    clearTimeout(late);
  }
}

// Behind an open window the page takes no clicks; one at the place of the stop is a stop all the same.
export function pressStopAt(x: number, y: number): void {
  const button = document.querySelector<HTMLElement>("button.stop"), box = button?.getBoundingClientRect();
  if (button && box && x >= box.left && x <= box.right && y >= box.top && y <= box.bottom) button.click();
}

// To the stop from a window that holds the focus, once that is closed.
export function focusStop(close: () => void): void {
  close();
  setTimeout(() => document.querySelector<HTMLElement>("button.stop")?.focus());
}

export function StopButton(): JSX.Element {
  const bench = useStore(benchInSight), trouble = useStore(stopTrouble);
  const [state, setState] = useState<"" | "sending" | "taken">("");
  const stop = async () => {
    setState("sending");
    setState(await pressStop(bench) ? "taken" : "");
    setTimeout(() => setState((one) => (one === "taken" ? "" : one)), 1500);
  };
  const words = trouble ? (trouble.state === "taken alone" ? t("delivered") : t("NOT delivered")) : state === "sending" ? t("sending") : state === "taken" ? t("sent") : stopScope(bench);
  return (
    <button type="button" class="stop" onClick={() => void stop()}>
      {t("Emergency stop")} <small>{words}</small>
    </button>
  );
}

export function StopTrouble(): JSX.Element | null {
  const trouble = useStore(stopTrouble);
  if (!trouble) return null;
  return (
    <div class="alarm" role="alert">
      <p>{wordsOf(trouble)} {trouble.state === "taken alone" ? t("Look at the bench.") : t("Use the stop at the bench.")}</p>
      {trouble.refused ? <p><English>{trouble.refused.message}</English>{trouble.refused.fix ? <>{"; "}<English>{trouble.refused.fix}</English></> : null}</p> : null}
      {trouble.state === "tried" ? null : <button type="button" onClick={() => { stopTrouble.value = null; }}>{t("Hide this message")}</button>}
    </div>
  );
}

function wordsOf({ state, atMs }: Trouble): string {
  const time = clockTime(atMs);
  if (state === "taken alone") return t("The emergency stop was delivered at {time}: tests are being stopped. The service does not answer, so that this page shows what was before.", { time });
  if (state === "refused") return t("The emergency stop was NOT delivered: the service refused it at {time}.", { time });
  if (state === "given up") return t("The emergency stop was NOT delivered: the service did not answer. It has not been tried since {time}.", { time });
  return t("The emergency stop is NOT delivered: the service does not answer. It is tried again until {time}.", { time });
}
