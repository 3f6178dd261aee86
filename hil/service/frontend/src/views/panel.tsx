// The operator's panel: one screen of a bench, to be read from a few steps away and used by touch.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { to } from "../addresses.ts";
import { figure, limitText, reading, roughly, wordsOf } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { useLive, useLost, type BenchState, type Live } from "../live.ts";
import { useStore } from "../store.ts";
import { play, soundOf, soundOn, turnSound } from "../ui/sound.ts";
import { Actions } from "./bench-banner.tsx";
import { aboutBench, asOf, isCause, leftOf, lookOf, messageOf, nextOf, wordOf } from "./bench-words.ts";
import { PromptCard, useNow } from "./panel-prompt.tsx";
import { nameOf } from "./runs/run-name.ts";
import { NewestHandover } from "./team/handovers.tsx";

const SHOWN = ["motor_speed_rad_s", "vehicle_speed_m_s", "motor_torque_nm", "shaft_torque_nm"];
const EVERY_MS = 250;
const OLD_MS = 1500;

export function Panel({ bench }: { bench: string }): JSX.Element {
  const live = useLive(bench, SHOWN);
  const state = useStore(live.state);
  useSounds(state);
  return (
    <div class="panel">
      {state ? <State state={state} /> : <h1>{t("Bench {bench}", { bench })}</h1>}
      <Dials live={live} state={state} />
      {state?.running ? <Decided live={live} run={state.running.id} /> : null}
      <NewestHandover bench={bench} />
      <div class="row level">
        <SoundSwitch />
        <a href={to.bench(bench)}>{t("The bench with its plots, its queue and the form that starts a plan")}</a>
      </div>
    </div>
  );
}

function State({ state }: { state: BenchState }): JSX.Element {
  const { bench, running } = state, message = messageOf(state), prompt = running?.prompt ?? null;
  return (
    <section class={`banner ${lookOf(bench, running)}`} aria-label={t("State of {bench}", { bench: bench.name })}>
      <p class="kind">{aboutBench(bench, bench.title || bench.name)}</p>
      <h1 class="headline word" aria-live="assertive"><small>{bench.name}</small> {asOf(useLost(), wordOf(bench, running))}</h1>
      {running ? <Running state={state} /> : null}
      {bench.why && !running ? <p class="big"><English>{bench.why}</English></p> : null}
      <p class="big">{nextOf(state)}</p>
      {running && prompt ? <PromptCard prompt={prompt} run={running.id} reached={!bench.away_since} /> : null}
      {running && message && !prompt && !isCause(message, running) ? <p class="message" role="status"><English>{message}</English></p> : null}
      <Actions state={state} answers={!prompt} />
    </section>
  );
}

function Running({ state: { bench, running } }: { state: BenchState }): JSX.Element | null {
  const now = useNow(), left = leftOf(bench, running, now);
  if (!running) return null;
  return (
    <>
      <p class="big"><a href={to.run(running.id)}>{t("Run {run}", { run: running.id })}</a>{`: ${nameOf(running)}`}</p>
      <p class="quiet">{t("by {person}", { person: running.requested_by })}, <English>{running.doing}</English>{left === null ? "" : `, ${t("about {time} left", { time: roughly(left) })}`}</p>
      <progress max={1} value={running.share ?? 0} aria-label={t("Progress of the run")} />
    </>
  );
}

function Dials({ live, state }: { live: Live; state: BenchState | null }): JSX.Element {
  const values = useNewest(live);
  return (
    <dl class="dials">
      {SHOWN.map((channel) => {
        const limit = state?.bench.limits[channel], value = values[channel] ?? null, unit = state?.bench.units[channel] ?? "";
        return (
          <div key={channel} class={limit && value !== null && Math.abs(value) > 0.9 * limit ? "near" : ""}>
            <dt>{wordsOf(channel)}</dt><dd>{reading(state?.running ? value : null, unit, "")} <small>{unit}</small></dd>
            <dd class="quiet">{limit ? t("limit ±{limit}", { limit: figure(limit, unit) }) : "\u00a0"}</dd>
          </div>
        );
      })}
    </dl>
  );
}

function Decided({ live, run }: { live: Live; run: number }): JSX.Element {
  const criteria = useStore(live.criteria), decided = criteria?.run === run ? criteria.criteria : [];
  const failed = decided.filter((one) => one.verdict === "fail");
  return (
    <section aria-label={t("Criteria")}>
      <p class={failed.length ? "big bad" : "big"}>{t("Criteria decided: {decided}, failed: {failed}", { decided: decided.length, failed: failed.length })}</p>
      {failed.map((one) => <p key={one.id} class="bad">{`${one.title || one.id}: ${figure(one.value, one.unit)} (${limitText(one.upper, one.lower)})`}</p>)}
    </section>
  );
}

function SoundSwitch(): JSX.Element {
  const on = useStore(soundOn);
  return <button type="button" aria-pressed={on} onClick={() => turnSound(!on)}>{on ? t("Sound is on") : t("Sound is off")}</button>;
}

function useSounds(state: BenchState | null): void {
  const before = useRef<BenchState | null>(null);
  useEffect(() => {
    if (!state) return;
    const sound = soundOf(before.current, state);
    before.current = state;
    if (sound) play(sound);
  }, [state]);
}

function useNewest(live: Live): Record<string, number | null> {
  const [values, setValues] = useState<Record<string, number | null>>({});
  useEffect(() => {
    let newest: Record<string, number | null> = {}, heard = 0;
    const stop = live.onSamples(({ channels }) => {
      heard = performance.now();
      newest = Object.fromEntries(Object.entries(channels).map(([name, { highest }]) => [name, highest.findLast((one) => one !== null) ?? null]));
    });
    // what is no longer measured must not stand there as if it were
    const timer = setInterval(() => setValues(performance.now() - heard < OLD_MS ? newest : {}), EVERY_MS);
    return () => { stop(); clearInterval(timer); };
  }, [live]);
  return values;
}
