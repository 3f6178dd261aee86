// Sentences of the service that are known by their form; names and figures in them stay.

import assert from "node:assert/strict";
import test from "node:test";
import { exactMoment, moment } from "../../../../hil/service/frontend/src/format.ts";
import { withLocalMoments } from "../../../../hil/service/frontend/src/i18n/local-moments.ts";
import { atThePage, translated, withoutPlace } from "../../../../hil/service/frontend/src/i18n/phrases.ts";

const KNOWN = [
  "drives enabled", "RMCU and dynos answer", "phase (phase stabilization) written, read back", "notch 2 (gain stabilization) written, read back", "dynos hold 20.0 km/h", "dynos simulate the vehicle",
  "gain_0kmh begins", "gain_0kmh ends", "gain_0kmh was stopped", "confirmed by RMCU and dynos", "resumes after 1.5 s: well again",
  "the bench loop was delayed by 0.2 s", "executed: ramp_down; the wheels turn at 0.08 rad/s, the RMCU is in 'off'", "cancelled by anna", "stopped by the operator", "beginning",
  "the service ended during the run; data measured before that is kept", "the agent ended before the recording started; the run can be queued again", "no answer to 'Is the cage shut?' within 600 s",
  "run 3 of an earlier service process is being ended", "the axle runs down", "a second person approves it", "another user holds the bench", "wait until it is released", "choose another time", "run 3 is finished", "run 4 is no longer queued",
  "the reservation is anna's", "the note is anna's", "ask an engineer", "there is no bench 'sim'", "segment 's' was not run", "segment 's' was stopped after 0.5 s", "anna has reserved the bench from 2026-11-28 15:44 UTC to 2026-11-28 17:14 UTC: axle 7",
];

for (const text of KNOWN) test(`known: ${text}`, () => assert.equal(translated(text), text));

// Of limits, devices and the way to safety: what a person must not read in a foreign language.
const OF_SAFETY = [
  "lower the plan's torque or speed; the limit is in the bench file", "see the recording's events; the bench file has the limits and interlocks", "bench limits: the limit is in the bench file", "warning: oil is hot",
  "RMCU status has stopped coming (the RMCU sends no status)", "is the device powered?", "the RMCU went to fault: 0x21", "rear left: heartbeat lost; rear right: drive in fault", "check RMCU",
  "safe state: RMCU did not confirm its safe state within 2 s; dynos did not confirm its safe state within 2 s: no answer", "cut the drives' power before you approach the bench",
  "the process that holds the bench: hung: it sent nothing for 3 s; safe: not confirmed (RMCU does not confirm that its torque is off)", "its process ended with code 3",
  "stopped before it began: emergency stop since 2026-11-28T12:37:18+00:00, by anna", "it could NOT be latched, so nothing prevents arming the bench again: no space",
  "torque at zero: the segment ends 1 s after the step, the window needs 2 s", "purpose", "vehicle inertia, half width, relative",
];

for (const text of OF_SAFETY) test(`known of safety: ${text}`, () => assert.equal(translated(text), text));

test("channels of limits are in words, and of a stop the way to reset it here", () => {
  assert.equal(translated("limit tripped: motor_speed_rad_s reached 712 rad/s, the limit is 700 rad/s"), "limit tripped: motor speed reached 712 rad/s, the limit is 700 rad/s");
  assert.equal(translated("oil: oil_c reached 91 °C, the limit is 90 °C; response: hold"), "oil: oil c reached 91 °C, the limit is 90 °C; response: pause");
  assert.equal(translated("make sure that no one is in danger, remove the cause; then: reset it at its service, or: hil bench reset sim --by NAME"), "make sure that no one is in danger and remove the cause; then reset it here");
});

test("what the engine holds is paused, to readers of English too", () => {
  assert.equal(translated("held, torque off, the dynos hold their speed: paused by the operator"), "paused, torque off, the dynos hold their speed: paused by the operator");
  assert.equal(atThePage("being ended: held: oil is hot"), "being ended: paused: oil is hot");
  assert.equal(atThePage("oil is hot: held for 600 s"), "oil is hot: paused for 600 s");
  assert.equal(atThePage("the speed is held"), "the speed is held");
});

test("of an emergency stop it stays when and by whom", () => {
  assert.equal(translated("emergency stop since 2026-11-28T12:37:18+00:00, by anna at 10.0.0.7: requested by anna at 10.0.0.7 at the bench service"), "emergency stop since 2026-11-28T12:37:18+00:00, by anna at 10.0.0.7");
});

test("what is not known is left to be read as English", () => {
  for (const text of ["", "the motor answers with an error", "drives enabled, but for one", "a b begins"]) assert.equal(translated(text), null);
});

test("of roles, stops and a run-down the figures and names stay", () => {
  assert.equal(translated("anna is viewer; operator is needed"), "anna has the role viewer; the role operator is needed");
  assert.equal(translated("emergency stop: requested by anna from 10.0.0.7 over the service's API"), "emergency stop, requested by anna from 10.0.0.7");
  assert.equal(translated("make sure that no one is in danger; then: reset it at its service, or: hil bench reset sim --by NAME"), "make sure that no one is in danger; then reset it here");
  assert.equal(translated("begins, no device gives torque; the axle turns: motor_speed_rad_s reads 141 rad/s"), "the run-down begins, no device gives torque; motor speed 141 rad/s");
  assert.equal(translated("ends after 10 s: not recorded any longer; the axle turns: motor_speed_rad_s reads 138 rad/s"), "the run-down is not recorded any longer after 10 s; motor speed 138 rad/s");
  assert.equal(translated("ends after 4.2 s: the axle stands"), "the run-down ends after 4.2 s: the axle stands");
});

test("of several refusals in one each is known, and what it is about stays", () => {
  const holds = "stays in service: run 3 (short, of anna) waits in its queue; anna has it until 2026-11-28 17:14 UTC; and 2 more";
  const fields = "2 fields are wrong\n  reason must have at most 200 characters\n  ends must be later than begins, by 31 days at most";
  assert.equal(translated(holds), holds);
  assert.equal(translated(fields), fields.replace("reason must", "reason: must"));
  assert.equal(translated("run 7: has 200 notes"), "run 7: has 200 notes");
  assert.equal(translated("here: something else"), null);
});

test("kinds and states in a refusal are in the reader's words", () => {
  assert.equal(translated("recording 4 is checking"), "recording 4 is checking");
  assert.equal(translated("campaign 4 is waiting_approval"), "campaign 4 is waiting approval");
  assert.equal(translated("there is no valid token '7'"), "there is no valid token '7'");
});

test("moments in texts are those of the reader's clock", () => {
  const shown = moment("2026-11-28T12:37:00Z"), exact = exactMoment("2026-11-28T12:37:18Z");
  assert.match(exact, /:37:18/); // to the second where it is said so
  assert.equal(withLocalMoments("since 2026-11-28T12:37:18+00:00, by anna"), `since ${exact}, by anna`);
  assert.equal(withLocalMoments("from 2026-11-28 12:37 UTC to later"), `from ${shown} to later`);
  assert.equal(withLocalMoments("version 2026-11-28, 99-99 2026-99-99T99:99:99Z"), "version 2026-11-28, 99-99 2026-99-99T99:99:99Z");
});

test("a place on the service's machine is a download or a button here, to readers of English too", () => {
  const safe = "cut the drives' power before you approach the bench", recover = "hil evidence recover /srv/hil/runs/12 recovers the recording of what was measured";
  const download = "the recording of what was measured is among this run's files; once downloaded, hil evidence recover recording.mcap mends it";
  assert.deepEqual([atThePage(recover), translated(recover)], [download, download]);
  assert.equal(atThePage(`${safe}; ${recover}`), `${safe}; ${download}`);
  assert.equal(atThePage("make sure that no one is in danger; then: reset it at its service, or: hil bench reset /srv/hil/b.toml --by NAME --data /srv/hil"), "make sure that no one is in danger; then reset it here");
  assert.equal(atThePage("make them with: hil report /srv/hil/runs/12"), "make them from the downloaded recording: hil report recording.mcap");
  assert.equal(withoutPlace("/srv/hil/runs/12: 7 MB are free"), "7 MB are free");
  assert.equal(withoutPlace("/srv/hil/plans/a.yaml: is not UTF-8"), "a.yaml: is not UTF-8");
  assert.equal(withoutPlace("/dev/ttyUSB0: no answer"), "/dev/ttyUSB0: no answer");
});
