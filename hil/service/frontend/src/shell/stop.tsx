// The emergency stop: on every page, of the bench in sight, else of all; nobody has to be signed in for it.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { stopNow } from "../api/client.ts";
import { attempt } from "../data.ts";
import { t } from "../i18n/text.ts";
import { Store, useStore } from "../store.ts";

// The bench that the view is about; '' for all.
export const benchInSight = new Store("");

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
      {t("Emergency stop")} <small>{sent ? t("sent") : bench || t("all benches")}</small>
    </button>
  );
}
