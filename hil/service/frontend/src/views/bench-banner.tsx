// What a bench does at one look, and what may be done about it now.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, post } from "../api/client.ts";
import { to } from "../addresses.ts";
import type { Bench, Run } from "../api/types.ts";
import { attempt, useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tx } from "../i18n/text.ts";
import { useLost, type BenchState } from "../live.ts";
import { agreed } from "../question.ts";
import { useMay, useMe } from "../session.ts";
import { linkTo } from "../ui/parts.tsx";
import { LimitedField } from "../ui/too-long.tsx";
import { LONGEST_ANSWER, PromptCard } from "./panel-prompt.tsx";
import { aboutBench, asOf, headlineOf, isCause, isEnding, isHeld, lookOf, messageOf, nextIn, nextOf, stoppingText } from "./bench-words.ts";
import { Reset } from "./reset.tsx";
import { nameOf } from "./runs/run-name.ts";

export function Banner({ state, level = 2 }: { state: BenchState; level?: 1 | 2 }): JSX.Element {
  const { bench, running } = state, message = messageOf(state), held = isHeld(running) && bench.state === "running";
  const words = asOf(useLost(), headlineOf(bench, running ? nameOf(running) : null, isEnding(running), held, Boolean(running?.prompt)));
  const Title = level === 1 ? "h1" : "h2";
  return (
    <section class={`banner ${lookOf(bench, running)}`} aria-label={t("State of {bench}", { bench: bench.name })}>
      <p class="kind">{aboutBench(bench, bench.title || bench.name)}</p>
      <Title class="headline" aria-live="polite">{level === 1 ? <><small>{t("Bench {bench}", { bench: bench.name })}</small>{" "}</> : null}{words}</Title>
      {running ? <p>{tx("<a>Run {run}</a>, by {person}: {doing}", { a: linkTo(to.run(running.id)), run: running.id, person: running.requested_by, doing: <English>{running.doing}</English> })}</p> : null}
      {held && !running?.prompt ? <p>{nextOf(state)}</p> : null}
      {bench.why && !(running && bench.state === "running") ? <p><English>{bench.why}</English></p> : null}
      {bench.state === "emergency_stop" ? <p>{nextOf(state)}</p> : null}
      {running ? <progress max={1} value={running.share ?? 0} aria-label={t("Progress of the run")} /> : null}
      {running?.prompt ? <PromptCard prompt={running.prompt} run={running.id} reached={!bench.away_since} /> : message && !isCause(message, running) ? <p class="message" role="status"><English>{message}</English></p> : null}
      <Actions state={state} answers={!running?.prompt} />
    </section>
  );
}

export function Actions({ state, answers = true }: { state: BenchState; answers?: boolean }): JSX.Element | null {
  const { bench, running, queue } = state, message = messageOf(state);
  const may = useMay(), me = useMe();
  const name = encodeURIComponent(bench.name);
  const reached = !bench.away_since;
  const held = isHeld(running), stopped = bench.state === "emergency_stop";
  const [ended, setEnded] = useState<number | null>(null); // the run whose end was asked for here just now
  const ending = isEnding(running) || (running !== null && ended === running.id);
  const end = (run: number) => {
    setEnded(run);
    void attempt(() => post(`/runs/${run}/abort`).then(() => true)).then((taken) => { if (!taken) setEnded(null); });
  };
  const order = (what: string) => () => void attempt(() => post(`/runs/${running?.id}/${what}`));
  const release = async () => {
    const words = t("Is {bench} no longer driven by its agent? It can then be driven by another agent. A run of this agent is marked as interrupted.", { bench: bench.name });
    if (await agreed(words, t("Release from its agent"), t("Cancel"))) void attempt(() => ask("DELETE", `/benches/${name}/agent`));
  };
  const mayReset = bench.state === "emergency_stop" && !running && may("engineer");
  const mayRelease = bench.lease === me.name || may("engineer");
  return (
    <>
      {answers && running && message && !held && may("operator") && reached ? <AnswerForm run={running.id} /> : null}
      <div class="row">
        {running && may("operator") && reached && !held && !stopped ? <button type="button" disabled={ending} onClick={order("pause")}>{t("Pause")}</button> : null}
        {running && may("operator") && reached && held && !stopped ? <button type="button" class="main" disabled={ending} onClick={order("resume")}>{t("Resume")}</button> : null}
        {running && may("operator") && !stopped ? <button type="button" disabled={ending} onClick={() => end(running.id)}>{ending ? t("Being ended") : t("End the run")}</button> : null}
        {mayReset ? <Reset bench={bench} next={nextIn(queue)} /> : null}
        {bench.away_since && may("engineer") ? <button type="button" onClick={() => void release()}>{t("Release from its agent")}</button> : null}
        {!bench.lease && may("operator") && (!bench.reserved_by || bench.reserved_by === me.name) ? <button type="button" onClick={() => void attempt(() => ask("PUT", `/benches/${name}/lease`, { for_s: 3600 }))}>{t("Reserve for an hour")}</button> : null}
        {bench.lease && may("operator") && mayRelease ? <button type="button" onClick={() => void attempt(() => ask("DELETE", `/benches/${name}/lease`))}>{t("End the reservation")}</button> : null}
      </div>
    </>
  );
}

// Where a run is shown that was stopped, and its bench still is.
export function ResetOf({ bench }: { bench: Bench }): JSX.Element | null {
  if (bench.state !== "emergency_stop") return null;
  return (
    <section class="banner emergency_stop" aria-label={t("State of {bench}", { bench: bench.name })}>
      <p>{bench.why ? <English>{bench.why}</English> : t("Emergency stop")}</p>
      <AfterStop bench={bench} />
    </section>
  );
}

// What there is to do about a stop: whoever may resets it once its run has ended.
export function AfterStop({ bench }: { bench: Bench }): JSX.Element {
  const may = useMay(), queue = useData<Run[]>(`/benches/${encodeURIComponent(bench.name)}/queue`).data ?? [];
  if (bench.running) return <p>{stoppingText()}</p>;
  return may("engineer") ? <div class="row"><Reset bench={bench} next={nextIn(queue)} /></div> : <p>{t("When it is safe, an engineer resets the emergency stop.")}</p>;
}

function AnswerForm({ run }: { run: number }): JSX.Element {
  const [text, setText] = useState("");
  const send = (event: Event) => {
    event.preventDefault();
    void attempt(() => post(`/runs/${run}/answer`, { text }).then(() => true)).then((taken) => { if (taken) setText(""); });
  };
  return (
    <form class="row" onSubmit={send}>
      <LimitedField label={t("Answer")} most={LONGEST_ANSWER} value={text} onText={setText} />
      <button type="submit" class="main">{t("Send")}</button>
    </form>
  );
}

export function LostNotice(): JSX.Element | null {
  return useLost() ? <p class="alarm" role="alert">{t("The service does not answer. The values shown are not current. If necessary, press the emergency stop at the bench.")}</p> : null;
}
