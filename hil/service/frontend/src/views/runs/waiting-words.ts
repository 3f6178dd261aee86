// Why a run waits, and what ends its waiting: a sentence each.

import type { Bench, Run } from "../../api/types.ts";
import { moment } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { nameOf } from "./run-name.ts";

// A bench as far as this service knows it: null, it has none of this name.
export interface Around {
  bench: Bench | null;
  running: Run | null;
  queue: Run[];
}

export interface Waiting {
  kind: "approval" | "missing" | "stop" | "away" | "reservation" | "lease" | "run" | "ending" | "in_use" | "turn" | "soon";
  why: string;
  ends: string; // '' where nothing is to be done
  until?: string; // ISO 8601, of the moment in `why`
}

export function whyItWaits(run: Run, { bench, running, queue }: Around): Waiting {
  if (run.state === "waiting_approval") return { kind: "approval", why: t("It waits for approval, for its plan is hazardous: {hazard}.", { hazard: run.hazard ?? "" }), ends: t("An engineer other than {person} approves it.", { person: run.requested_by }) };
  if (!bench) return { kind: "missing", why: t("Its bench {bench} is not connected to this service.", { bench: run.bench }), ends: t("It starts when the bench is in service again, or it is cancelled.") };
  if (bench.state === "emergency_stop") return { kind: "stop", why: t("It waits because the emergency stop of {bench} is latched.", { bench: bench.name }), ends: running ? t("The run under way is being ended; then an engineer resets the stop when it is safe.") : t("Make sure that no one is in danger and that the cause is gone. Then an engineer resets the stop, here or at the bench, and the runs that wait go on by themselves; a run that is not to start is cancelled before.") };
  if (bench.state === "away") return { kind: "away", why: bench.away_since ? t("The agent of {bench} has not been heard of since {moment}.", { bench: bench.name, moment: moment(bench.away_since) }) : t("The agent of {bench} is not connected.", { bench: bench.name }), ends: t("It starts when the agent is connected again.") };
  const held = run.waits_for;
  if (held) return { kind: "reservation", why: t("It waits for the reservation of {who} until {end}: {reason}.", { who: held.who, end: moment(held.ends), reason: held.reason }), ends: t("It starts after that, or when {who} lets it start.", { who: held.who }), until: held.ends };
  if (bench.lease && bench.lease !== run.requested_by) return { kind: "lease", why: bench.lease_until ? t("{who} has the bench until {end}.", { who: bench.lease, end: moment(bench.lease_until) }) : t("{who} has the bench.", { who: bench.lease }), ends: t("It starts after that, or when {who} or an engineer ends the reservation.", { who: bench.lease }), until: bench.lease_until ?? "" };
  if (running && running.id !== run.id) return behind(run, running, queue);
  if (bench.state === "ending") return { kind: "ending", why: t("A run that an earlier service left behind is being ended on {bench}.", { bench: bench.name }), ends: t("It starts after that by itself.") };
  if (bench.state === "in_use") return { kind: "in_use", why: t("Another program drives {bench}.", { bench: bench.name }), ends: t("It starts when that program has ended.") };
  const before = countBefore(run, queue);
  if (before) return { kind: "turn", why: inFront(before, queue), ends: t("It starts by itself when it is its turn; an engineer can have it sooner.") };
  return { kind: "soon", why: t("The bench is free. It is about to start."), ends: "" };
}

function behind(run: Run, running: Run, queue: Run[]): Waiting {
  const values = { run: running.id, plan: nameOf(running), person: running.requested_by }, before = countBefore(run, queue);
  const why = running.prompt ? t("Run {run} ({plan}, by {person}) is on the bench and waits for an answer.", values)
    : running.expected_end ? t("Run {run} ({plan}, by {person}) is on the bench, until about {end}.", { ...values, end: moment(running.expected_end) })
      : t("Run {run} ({plan}, by {person}) is on the bench.", values);
  return { kind: "run", why: before ? `${why} ${inFront(before, queue)}` : why, ends: running.prompt ? t("It starts by itself after that run, which goes on when an operator answers.") : t("It starts by itself when that run has ended and it is its turn."), until: running.expected_end ?? "" };
}

// Runs before it that may start as they are.
const countBefore = (run: Run, queue: Run[]): number =>
  queue.slice(0, Math.max(0, queue.findIndex((one) => one.id === run.id))).filter((one) => one.state === "queued" && !one.waits_for).length;

function inFront(count: number, queue: Run[]): string {
  const next = queue.find((one) => one.state === "queued" && !one.waits_for);
  return count === 1 && next ? t("Run {run} of {person} is before it.", { run: next.id, person: next.requested_by }) : t("{count} runs are before it.", { count });
}
