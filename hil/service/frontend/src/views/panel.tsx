// The operator's panel: one screen of a bench, to be read and used from a few steps away.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { to } from "../addresses.ts";
import { figure, limitText, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import { useLive, type Live } from "../live.ts";
import { benchInSight } from "../shell/stop.tsx";
import { useStore } from "../store.ts";
import { Banner, LostNotice } from "./bench-banner.tsx";

const SHOWN = ["motor_speed_rad_s", "vehicle_speed_m_s", "motor_torque_nm", "shaft_torque_nm"];
const EVERY_MS = 250;

export function Panel({ bench }: { bench: string }): JSX.Element {
  const live = useLive(bench, SHOWN);
  const state = useStore(live.state), criteria = useStore(live.criteria);
  const values = useNewest(live);
  useEffect(() => { benchInSight.value = bench; }, [bench]);
  const decided = criteria && state?.running?.id === criteria.run ? criteria.criteria : [];
  const failed = decided.filter((one) => one.verdict === "fail");
  return (
    <div class="panel">
      <LostNotice />
      {state ? <Banner state={state} level={1} /> : <h1>{t("Bench {bench}", { bench })}</h1>}
      <dl class="dials">
        {SHOWN.map((channel) => {
          const limit = state?.bench.limits[channel], value = values[channel] ?? null, unit = state?.bench.units[channel] ?? "";
          return (
            <div key={channel} class={limit && value !== null && Math.abs(value) > 0.9 * limit ? "near" : ""}>
              <dt>{wordsOf(channel)}</dt><dd>{figure(state?.running ? value : null)} <small>{unit}</small></dd>
              <dd class="quiet">{limit ? t("limit ±{limit}", { limit: figure(limit, unit) }) : "\u00a0"}</dd>
            </div>
          );
        })}
      </dl>
      {state?.running ? (
        <section aria-label={t("Criteria")}>
          <p class="big">{t("{count} criteria decided, ", { count: decided.length })}<span class={failed.length ? "bad" : ""}>{t("{count} failed", { count: failed.length })}</span></p>
          {failed.map((one) => <p key={one.id} class="bad">{`${one.title || one.id}: ${figure(one.value, one.unit)} (${limitText(one.upper, one.lower)})`}</p>)}
        </section>
      ) : null}
      {state?.queue.length ? <p class="big">{`Next: ${state.queue[0]?.title || state.queue[0]?.plan}, by ${state.queue[0]?.requested_by}${state.queue.length > 1 ? `, and ${state.queue.length - 1} more` : ""}`}</p> : <p class="big quiet">{t("Nothing waits.")}</p>}
      <p><a href={to.bench(bench)}>{t("The bench with its plots, its queue and the form that starts a plan")}</a></p>
    </div>
  );
}

function useNewest(live: Live): Record<string, number | null> {
  const [values, setValues] = useState<Record<string, number | null>>({});
  useEffect(() => {
    let newest: Record<string, number | null> = {};
    const stop = live.onSamples(({ channels }) => {
      newest = Object.fromEntries(Object.entries(channels).map(([name, { highest }]) => [name, highest.findLast((one) => one !== null) ?? null]));
    });
    const timer = setInterval(() => setValues(newest), EVERY_MS);
    return () => { stop(); clearInterval(timer); };
  }, [live]);
  return values;
}
