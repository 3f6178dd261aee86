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

export function StopButton(): JSX.Element {
  const bench = useStore(benchInSight);
  const [sent, setSent] = useState(false);
  const stop = async () => {
    setSent(true);
    await attempt(() => stopNow(bench));
    setTimeout(() => setSent(false), 1500);
  };
  return (
    <button type="button" class="stop" onClick={() => void stop()}>
      {t("Emergency stop")} <small>{sent ? t("sent") : stopScope(bench)}</small>
    </button>
  );
}
