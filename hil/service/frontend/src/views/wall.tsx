// The wall of a control room: all benches, or one, to be read from five metres. It takes no input and follows by itself.

import type { JSX } from "preact";
import { useEffect, useMemo, useState } from "preact/hooks";
import { to } from "../addresses.ts";
import { clockTime, moment, roughly } from "../format.ts";
import { English } from "../i18n/english.tsx";
import { t } from "../i18n/text.ts";
import { showAs } from "../theme.ts";
import { Badge, verdictOf } from "../ui/parts.tsx";
import { headlineOf, holderOf, isReserved, leftOf, lookOf, nextIn, reservedText, wallWordOf } from "./bench-words.ts";
import { nameOf, shortNameOf } from "./runs/run-name.ts";
import { useNow } from "./panel-prompt.tsx";
import { useWall, type Shown } from "./wall-data.ts";

const OLD_S = 10;
const VERDICTS = { all: 2, one: 4 };

export function Wall({ bench }: { bench: string | null }): JSX.Element {
  const { shown, missing, atMs } = useWall(bench), now = useNow(), began = useBegan();
  useEffect(() => showAs("dark"), []);
  const ageS = Math.round((performance.now() - (atMs || began)) / 1000), old = ageS > OLD_S;
  const columns = Math.ceil(Math.sqrt(Math.max(1, shown.length))), rows = Math.max(1, Math.ceil(shown.length / columns));
  return (
    <div class={old ? "wall old" : "wall"} style={{ "--columns": columns, "--rows": rows }}>
      <header>
        <h1>{bench === null ? t("All benches") : t("Bench {bench}", { bench })}</h1>
        <p class="clock">{clockTime(now)}</p>
      </header>
      {old ? <p class="alarm" role="alert">{t("NOT CURRENT: no answer of the service for {time}", { time: roughly(ageS) })}</p> : null}
      {missing ? <p class="alarm">{t("The service has no bench of this name.")}</p> : null}
      {missing ? <p><a href={to.wall()}>{t("All benches")}</a></p> : null}
      {atMs && !missing && !shown.length ? <p>{t("No bench yet.")}</p> : null}
      <ul>{shown.map((one) => <Card key={one.bench.name} of={one} nowMs={now} alone={bench !== null} />)}</ul>
    </div>
  );
}

const useBegan = (): number => useState(() => performance.now())[0];

// How wide a word is in Latin letters: those of Chinese and Japanese are about twice as wide.
const lettersOf = (word: string): number => [...word].reduce((sum, letter) => sum + (letter > "\u2e7f" ? 1.8 : 1), 0);

function Card({ of: { bench, running, queue, latest }, nowMs, alone }: { of: Shown; nowMs: number; alone: boolean }): JSX.Element {
  const seenMs = useMemo(() => nowMs, [running?.id, running?.share]); // of a service that is away nothing is newer
  const left = leftOf(bench, running, seenMs);
  const next = nextIn(queue), has = running?.requested_by || holderOf(bench);
  return (
    <li class={`bench ${lookOf(bench, running)}`}>
      <h2><a href={to.wall(bench.name)}>{bench.name}</a> {bench.title ? <small>{bench.title}</small> : null}</h2>
      <p class="state" style={{ "--letters": lettersOf(wallWordOf(bench, running)) }}>{wallWordOf(bench, running)}</p>
      {bench.stop_confirmed === false ? <p class="bad">{headlineOf(bench, null)}</p> : null}
      {has ? <p>{running ? t("by {person}", { person: has }) : isReserved(bench) ? reservedText(bench) : t("reserved by {person}", { person: has })}</p> : null}
      {running ? (
        <>
          <p class="plan">{nameOf(running)}</p>
          <progress max={1} value={running.share ?? 0} aria-label={t("Progress of run {run}", { run: running.id })} />
          <p>{left === null ? <English>{running.doing}</English> : t("about {time} left", { time: roughly(left) })}</p>
        </>
      ) : bench.why ? <p class="why"><English>{bench.why}</English></p> : null}
      {next ? <p class="quiet">{queue.length > 1 ? t("Next: {plan}, by {person}, and {count} more", { plan: shortNameOf(next), person: next.requested_by, count: queue.length - 1 }) : t("Next: {plan}, by {person}", { plan: shortNameOf(next), person: next.requested_by })}</p> : null}
      <ol aria-label={t("Last verdicts")}>
        {latest.slice(0, alone ? VERDICTS.one : VERDICTS.all).map((run) => (
          <li key={run.id}><Badge kind={verdictOf(run)} /> <span>{shortNameOf(run)}</span> {run.ended_at ? <time dateTime={run.ended_at} title={run.ended_at}>{moment(run.ended_at)}</time> : null}</li>
        ))}
      </ol>
    </li>
  );
}
