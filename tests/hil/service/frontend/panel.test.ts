// What the operator's panel and the wall say of a bench, and when they sound.

import assert from "node:assert/strict";
import test from "node:test";
import type { Bench, Run } from "../../../../hil/service/frontend/src/api/types.ts";
import type { BenchState } from "../../../../hil/service/frontend/src/live.ts";
import { soundOf } from "../../../../hil/service/frontend/src/ui/sound.ts";
import { aboutBench, asOf, headlineOf, isFreshStandstill, isRecentLook, isSeenTurning, lastSpeedText, leftOf, messageOf, nextOf, wallWordOf, wordOf } from "../../../../hil/service/frontend/src/views/bench-words.ts";

const RUN = { id: 7, plan: "steps", title: "Steps", values: {}, requested_by: "anna", doing: "tip_in", share: 0.25, state: "running", started_at: "2026-11-28T10:00:00Z" } as Run;
const QUESTION = { text: "Is the cage shut?", answer_by: "2026-11-28T10:10:00Z", picture: "" };
const stateOf = (state: Bench["state"], running: Run | null = null, queue: Run[] = []): BenchState => ({ bench: { name: "sim", state, lease: "" } as Bench, running, message: "", queue, viewers: [] });

test("a bench is said in one word", () => {
  const words = (state: BenchState) => wordOf(state.bench, state.running);
  assert.deepEqual(
    [stateOf("free"), stateOf("running", RUN), stateOf("running", { ...RUN, doing: "held: oil" }), stateOf("running", { ...RUN, prompt: QUESTION }), stateOf("emergency_stop", RUN)].map(words),
    ["Free", "Running", "Paused", "Question", "Emergency stop"],
  );
});

test("a paused run is headed so, and its message has no keys of a terminal", () => {
  const held = { ...RUN, doing: "held: oil" }, { bench } = stateOf("running", held), message = "held: oil\nlet it cool\nr and Enter: resume; q and Enter: end the run";
  assert.deepEqual([headlineOf(bench, "Steps", false, true), headlineOf(bench, "Steps")], ["Paused: Steps", "Running: Steps"]);
  assert.deepEqual([headlineOf(bench, "Steps", false, true, true), asOf(true, "Free"), asOf(false, "Free")], ["Question: Steps", "Last known: Free", "Free"]);
  assert.equal(messageOf({ running: held, message }), "held: oil\nlet it cool");
  assert.equal(messageOf({ running: RUN, message }), "");
});

test("what comes next is the queue's first, unless somebody has to do something before", () => {
  const waiting = { ...RUN, id: 8, state: "queued" } as Run;
  assert.equal(nextOf(stateOf("free")), "Nothing waits.");
  assert.equal(nextOf(stateOf("running", RUN, [waiting, waiting])), "Next: Steps, by anna, and 1 more");
  assert.match(nextOf(stateOf("free", null, [{ ...waiting, state: "waiting_approval" }])), /when an engineer approves/);
  assert.match(nextOf(stateOf("running", { ...RUN, prompt: QUESTION }, [waiting])), /question is answered/);
  assert.match(nextOf(stateOf("emergency_stop", null, [waiting])), /engineer resets/);
});

test("a run that waits for somebody's reservation is not next while another may start", () => {
  const held = { ...RUN, id: 8, state: "queued", waits_for: { who: "chen" } } as Run, free = { ...RUN, id: 9, state: "queued", requested_by: "ben" } as Run;
  assert.equal(nextOf(stateOf("free", null, [held, free])), "Next: Steps, by ben, and 1 more");
  assert.equal(nextOf(stateOf("free", null, [held])), "Next: Steps, by anna");
});

test("a bench that is reserved says for whom and until when; while it is used, who has it stands beside its title", () => {
  const bench = stateOf("free").bench, ends = "2020-01-02T12:00:00Z";
  assert.match(headlineOf({ ...bench, reserved_by: "chen", reserved_until: ends }, null), /^Reserved for chen until .*2020/);
  assert.match(wordOf({ ...bench, lease: "anna", lease_until: ends, reserved_by: "chen" }, null), /^Reserved for anna until /);
  assert.equal(headlineOf({ ...bench, lease: "anna" }, null), "Reserved for anna");
  assert.equal(wallWordOf({ ...bench, lease: "anna" }, null), "Reserved");
  assert.equal(aboutBench({ ...bench, lease: "anna" }, "Axle 1"), "Axle 1");
  assert.equal(aboutBench({ ...bench, state: "running", reserved_by: "chen" }, "Axle 1"), "Axle 1, reserved by chen");
  assert.equal(headlineOf(bench, null), "Free");
});

test("what is left is as long as what was, by their shares", () => {
  const now = Date.parse("2026-11-28T10:01:00Z"), { bench } = stateOf("running");
  assert.equal(leftOf(bench, RUN, now), 180);
  assert.equal(leftOf(bench, { ...RUN, share: 0 }, now), null);
  assert.equal(leftOf(stateOf("emergency_stop").bench, RUN, now), null);
});

test("a trip, a question and an end sound once, and the first look at a bench does not", () => {
  const running = stateOf("running", RUN), asked = stateOf("running", { ...RUN, prompt: QUESTION }), stopped = stateOf("emergency_stop", RUN);
  assert.equal(soundOf(null, stopped), null);
  assert.equal(soundOf(running, stopped), "trip");
  assert.equal(soundOf(stopped, stateOf("emergency_stop")), "end");
  assert.equal(soundOf(running, stateOf("running", { ...RUN, doing: "held: oil" })), "trip");
  assert.deepEqual([soundOf(running, asked), soundOf(asked, asked), soundOf(asked, running), soundOf(asked, stateOf("free"))], ["prompt", null, null, "end"]);
});

test("beside a reset stands the speed that was measured last, and how long ago", () => {
  const at = "2026-11-28T10:00:00Z", now = Date.parse(at) + 12_000, { bench } = stateOf("emergency_stop");
  assert.equal(lastSpeedText({ ...bench, last_speed: { speed_rad_s: -137, at, turns: true } }, now), "At the last look, 12\u00a0s ago, the motor turned at 137\u00a0rad/s.");
  assert.match(lastSpeedText({ ...bench, last_speed: { speed_rad_s: 0.1, at, turns: false } }, now), /stood/);
  assert.match(lastSpeedText(bench, now), /not known: the service was started since.*Look whether the axle stands/);
});

test("a look at the speed counts for five seconds, and looks go on where the newest is of the last ten", () => {
  const at = "2026-11-28T10:00:00Z", now = Date.parse(at) + 4000, late = now + 2000, { bench } = stateOf("emergency_stop");
  const stood = { ...bench, last_speed: { speed_rad_s: 0.1, at, turns: false } }, turned = { ...bench, last_speed: { speed_rad_s: 90, at, turns: true } };
  assert.deepEqual([isFreshStandstill(stood, now), isFreshStandstill(stood, late), isFreshStandstill(turned, now), isFreshStandstill(bench, now)], [true, false, false, false]);
  assert.deepEqual([isRecentLook(turned, late), isRecentLook(turned, late + 5000), isRecentLook(bench, now)], [true, false, false]);
  assert.deepEqual([isSeenTurning(turned, late), isSeenTurning(turned, late + 5000), isSeenTurning(stood, late), isSeenTurning(bench, now)], [true, false, false, false]);
});

test("from a stop to the end of its run it is said when somebody can reset it", () => {
  assert.match(nextOf(stateOf("emergency_stop", RUN)), /^Stopping: .*When the run has ended, an engineer can reset the emergency stop\.$/);
  assert.equal(nextOf(stateOf("emergency_stop")), "When it is safe, an engineer resets the emergency stop.");
});

test("a run of which somebody has asked for the end is being ended, whatever else it does", () => {
  const ending = stateOf("running", { ...RUN, doing: "being ended: held: oil", prompt: QUESTION });
  assert.equal(wordOf(ending.bench, ending.running), "Being ended");
  assert.equal(headlineOf(ending.bench, "Steps", true), "Being ended: Steps");
  assert.equal(nextOf(ending), "The run is being ended.");
  assert.equal(leftOf(ending.bench, ending.running, Date.parse("2026-11-28T10:00:30Z")), null);
});
