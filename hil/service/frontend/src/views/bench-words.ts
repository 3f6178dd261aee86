// States of a bench in words: what it does, who has it, what comes next.

import type { Bench, Run } from "../api/types.ts";
import { figure, nearMoment, roughly } from "../format.ts";
import { translated } from "../i18n/phrases.ts";
import { t } from "../i18n/text.ts";
import type { BenchState } from "../live.ts";
import { nameOf } from "./runs/run-name.ts";

const STATES: Record<Bench["state"], string> = {
  free: t("Free"), running: t("Running"), ending: t("Ending a lost run"), in_use: t("In use"), emergency_stop: t("Emergency stop"), away: t("Agent not connected"),
};

export const isHeld = (run: Run | null): boolean => run?.doing.startsWith("held") ?? false;

// Somebody has asked for its end: that cannot be taken back.
export const isEnding = (run: Run | null): boolean => run?.doing.startsWith("being ended") ?? false;

// Who has a bench for a while from now on, or by a reservation that is under way; '' for no one.
export const holderOf = (bench: Bench): string => bench.lease || (bench.reserved_by ?? "");

// One that does nothing, and that nobody but its holder can use now.
export const isReserved = (bench: Bench): boolean => bench.state === "free" && holderOf(bench) !== "";

export function reservedText(bench: Bench): string {
  const who = holderOf(bench), until = bench.lease ? bench.lease_until : bench.reserved_until;
  return until ? t("Reserved for {who} until {end}", { who, end: nearMoment(until) }) : t("Reserved for {who}", { who });
}

// The colours of a bench: its state, or that it waits for a person.
export const lookOf = (bench: Bench, run: Run | null): string => (run?.prompt || isReserved(bench) ? "in_use" : bench.state);

// `ending`: its run is being ended; `held`: it waits for a cause to be gone or for Resume; `asks`: it waits for an answer.
export function headlineOf(bench: Bench, title: string | null, ending = false, held = false, asks = false): string {
  if (bench.stop_confirmed === false) return t("Emergency stop asked for, NOT CONFIRMED");
  if (title !== null && bench.state === "running") {
    if (ending) return t("Being ended: {plan}", { plan: title });
    if (asks) return t("Question: {plan}", { plan: title });
    return held ? t("Paused: {plan}", { plan: title }) : t("Running: {plan}", { plan: title });
  }
  return isReserved(bench) ? reservedText(bench) : STATES[bench.state];
}

// What a bench did when the service was last heard of: of now nothing is known.
export const asOf = (isLost: boolean, words: string): string => (isLost ? t("Last known: {state}", { state: words }) : words);

// To be read from afar.
export function wordOf(bench: Bench, run: Run | null): string {
  if (bench.state !== "running" || bench.stop_confirmed === false) return headlineOf(bench, null);
  return isEnding(run) ? t("Being ended") : run?.prompt ? t("Question") : isHeld(run) ? t("Paused") : STATES.running;
}

// The largest word on the wall of a control room: one, and short.
const WALL: Record<Bench["state"], string> = { free: t("Free"), running: t("Running"), ending: t("Ending"), in_use: t("In use"), emergency_stop: t("STOP"), away: t("Away") };

export function wallWordOf(bench: Bench, run: Run | null): string {
  if (bench.stop_confirmed === false) return WALL.emergency_stop;
  if (isReserved(bench)) return t("Reserved");
  return bench.state !== "running" ? WALL[bench.state] : isEnding(run) ? WALL.ending : run?.prompt ? t("Question") : isHeld(run) ? t("Paused") : WALL.running;
}

// The first that may start as it is; one that waits for somebody where none may.
export const nextIn = (queue: Run[]): Run | undefined => queue.find((run) => run.state === "queued" && !run.waits_for) ?? queue[0];

// What a run says for a terminal and for the page alike: without the keys of a terminal, which are buttons here.
export const messageOf = ({ running, message }: Pick<BenchState, "running" | "message">): string =>
  message.startsWith("held: ") && !isHeld(running) ? "" : message.split("\n").filter((line) => !KEYS.includes(line)).join("\n");

// Only what the run is doing, which stands there already.
export const isCause = (message: string, run: Run | null): boolean => message === run?.doing;

const KEYS = ["r and Enter: resume; q and Enter: end the run", "resumes by itself when the cause is gone"];

// What happens next, by itself or because somebody does something.
export function nextOf({ bench, running, queue }: BenchState): string {
  const first = nextIn(queue), more = queue.length - 1;
  if (bench.state === "emergency_stop") return running ? stoppingText() : t("When it is safe, an engineer resets the emergency stop.");
  if (isEnding(running)) return t("The run is being ended.");
  if (running?.prompt) return t("The run goes on when the question is answered.");
  if (running && isHeld(running)) return t("The run is paused and the torque is off. It goes on when the cause is gone, or with Resume.");
  if (!first) return t("Nothing waits.");
  const values = { plan: nameOf(first), person: first.requested_by, count: more };
  if (first.state === "waiting_approval") return t("Next, when an engineer approves it: {plan}, by {person}", values);
  return more > 0 ? t("Next: {plan}, by {person}, and {count} more", values) : t("Next: {plan}, by {person}", values);
}

// Where a bench is and who has it, behind its title.
export const aboutBench = (bench: Bench, title: string): string =>
  [title, bench.simulated ? t("simulated") : "", bench.machine ? t("at {machine}", { machine: bench.machine }) : "", holderOf(bench) && !isReserved(bench) ? t("reserved by {person}", { person: holderOf(bench) }) : ""].filter(Boolean).join(", ");

const LEAST_SHARE = 0.02; // of which the rest is estimated

// Seconds that are left of a run, if it goes on as so far; null where too little has been done.
export function leftOf(bench: Bench, run: Run | null, nowMs: number): number | null {
  if (!run || bench.state === "emergency_stop") return null;
  if (run.prompt || isHeld(run) || isEnding(run)) return null; // that takes as long as people take
  const share = run.share ?? 0, began = run.started_at ? Date.parse(run.started_at) : NaN;
  if (share < LEAST_SHARE || !Number.isFinite(began)) return null;
  return Math.max(0, ((nowMs - began) / 1000) * ((1 - share) / share));
}

// What the button does that resets a stop: the queue goes on.
export function resetText(next: Run | null | undefined): string {
  return next ? t("It is safe: reset the emergency stop. Run {run} starts then.", { run: next.id }) : t("It is safe: reset the emergency stop");
}

const FRESH_MS = 5000; // a look at the speed says something of now
const RECENT_MS = 10_000; // the newest of looks that go on: while an axle turns there is one every five or six seconds

const isWithin = (bench: Bench, nowMs: number, ms: number): boolean => bench.last_speed != null && nowMs - Date.parse(bench.last_speed.at) <= ms;

// Whether the service has just seen that the motor stands.
export const isFreshStandstill = (bench: Bench, nowMs: number): boolean => isWithin(bench, nowMs, FRESH_MS) && bench.last_speed?.turns === false;

// Whether the service's looks at the speed go on, so that what a window shows of it is of now.
export const isRecentLook = (bench: Bench, nowMs: number): boolean => isWithin(bench, nowMs, RECENT_MS);

// Whether the service has just seen that the motor turns: it resets no stop then.
export const isSeenTurning = (bench: Bench, nowMs: number): boolean => isRecentLook(bench, nowMs) && bench.last_speed?.turns === true;

// What happens from a stop to the end of its run: until then nobody can reset it, and somebody must afterwards.
export const stoppingText = (): string =>
  t("Stopping: the bench goes to its safe state, and what was measured is written down. When the run has ended, an engineer can reset the emergency stop.");

// The speed that was measured last before or after a stop, beside what resets it.
export function lastSpeedText(bench: Bench, nowMs: number): string {
  const last = bench.last_speed;
  if (!last && bench.speed_unknown) return t("The speed of the motor is not known: {why}. Look whether the axle stands.", { why: translated(bench.speed_unknown) ?? bench.speed_unknown });
  if (!last) return t("The speed of the motor is not known: the service was started since, or nothing was measured. Look whether the axle stands.");
  const values = { time: roughly(Math.max(0, (nowMs - Date.parse(last.at)) / 1000)), speed: figure(Math.abs(last.speed_rad_s), "rad/s") };
  return last.turns ? t("At the last look, {time} ago, the motor turned at {speed}.", values) : t("At the last look, {time} ago, the motor stood.", values);
}
