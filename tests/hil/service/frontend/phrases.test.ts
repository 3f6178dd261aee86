// Sentences of the service that are known by their form; names and figures in them stay.

import assert from "node:assert/strict";
import test from "node:test";
import { translated } from "../../../../hil/service/frontend/src/i18n/phrases.ts";

const KNOWN = [
  "drives enabled", "RMCU and dynos answer", "phase (phase stabilization) written, read back", "notch 2 (gain stabilization) written, read back", "dynos hold 20.0 km/h", "dynos simulate the vehicle",
  "gain_0kmh begins", "gain_0kmh ends", "gain_0kmh was stopped", "confirmed by RMCU and dynos", "held, torque off, the dynos hold their speed: oil is hot", "resumes after 1.5 s: well again",
  "the bench loop was delayed by 0.2 s", "executed: ramp_down; the wheels turn at 0.08 rad/s, the RMCU is in 'off'", "cancelled by anna", "stopped by the operator", "beginning",
  "the service ended during the run; data measured before that is kept", "the agent ended before the recording started; the run can be queued again", "no answer to 'Is the cage shut?' within 600 s",
  "run 3 of an earlier service process is being ended",
];

for (const text of KNOWN) test(`known: ${text}`, () => assert.equal(translated(text), text));

test("of an emergency stop it stays when and by whom", () => {
  assert.equal(translated("emergency stop since 2026-11-28T12:37:18+00:00, by anna at 10.0.0.7: requested by anna at 10.0.0.7 at the bench service"), "emergency stop since 2026-11-28T12:37:18+00:00, by anna at 10.0.0.7");
});

test("what is not known is left to be read as English", () => {
  for (const text of ["", "the motor answers with an error", "drives enabled, but for one", "a b begins"]) assert.equal(translated(text), null);
});
