// Sentences that the service says again and again, known by their form: shown in the reader's language.

import { wordsOf } from "../format.ts";
import { devicePhrases } from "./device-phrases.ts";
import { FIELD_REFUSALS } from "./field-refusals.ts";
import { FILE_REFUSALS } from "./file-refusals.ts";
import { FORM_WORDS } from "./form-words.ts";
import { judgingPhrases } from "./judging-phrases.ts";
import { HOLDS, REFUSALS } from "./refusal-phrases.ts";
import { pausePhrases, PLACES, runPhrases } from "./run-phrases.ts";
import { around, personIn, wordsOf as wordsOfFirst, type Phrase, type Said } from "./said.ts";
import { startPhrases } from "./start-phrases.ts";
import { t } from "./text.ts";

const named = (names = ""): string => (names === "RMCU and dynos" ? t("RMCU and dynos") : names);

const turning = (of: Said): Said => ({ ...of, channel: wordsOf(of["channel"] ?? "") });

const words = (text: string): string => translated(text) ?? text;

// The words in groups are names and figures; they stay as they are.
const FORMS: Phrase[] = [
  [/^drives enabled$/, () => t("drives enabled")],
  [/^(?<names>.+) answer$/, (of) => t("{names} answer", { names: named(of["names"]) })],
  [/^(?<name>.+) \((?<kind>gain|phase) stabilization\) written, read back$/, (of) => (of["kind"] === "gain" ? t("{name} (gain stabilization) written, read back", of) : t("{name} (phase stabilization) written, read back", of))],
  [/^dynos hold (?<speed>\S+) km\/h$/, (of) => t("dynos hold {speed} km/h", of)],
  [/^dynos simulate the vehicle$/, () => t("dynos simulate the vehicle")],
  [/^(?<segment>\S+) begins$/, (of) => t("{segment} begins", of)],
  [/^(?<segment>\S+) ends$/, (of) => t("{segment} ends", of)],
  [/^(?<segment>\S+) was stopped$/, (of) => t("{segment} was stopped", of)],
  [/^confirmed by (?<names>.+)$/, (of) => t("confirmed by {names}", { names: named(of["names"]) })],
  [/^the bench loop was delayed by (?<seconds>\S+) s$/, (of) => t("the bench loop was delayed by {seconds} s", of)],
  [/^executed: (?<steps>[^;]+); the wheels turn at (?<speed>\S+) rad\/s, the RMCU is in '(?<state>[^']+)'$/, (of) => t("executed: {steps}; the wheels turn at {speed} rad/s, the RMCU is in '{state}'", of)],
  [/^the axle runs down$/, () => t("the axle runs down")],
  [/^begins, no device gives torque; the axle turns: (?<channel>\S+) reads (?<speed>.+)$/, (of) => t("the run-down begins, no device gives torque; {channel} {speed}", turning(of))],
  [/^ends after (?<seconds>\S+) s: the axle stands$/, (of) => t("the run-down ends after {seconds} s: the axle stands", of)],
  [/^ends after (?<seconds>\S+) s: not recorded any longer; the axle turns: (?<channel>\S+) reads (?<speed>.+)$/, (of) => t("the run-down is not recorded any longer after {seconds} s; {channel} {speed}", turning(of))],
  [/^cancelled by (?<person>.+)$/, (of) => t("cancelled by {person}", of)],
  [/^stopped by the operator$/, () => t("stopped by the operator")],
  [/^stopped by the operator, who did not continue at '(?<question>.+)'$/s, (of) => t("stopped by the operator, who did not continue at '{question}'", of)],
  [/^the service ended during the run; data measured before that is kept$/, () => t("the service ended during the run; data measured before that is kept")],
  [/^the agent ended during the run; data measured before that is kept$/, () => t("the agent ended during the run; data measured before that is kept")],
  [/^the service ended before the recording started; the run can be queued again$/, () => t("the service ended before the recording started; the run can be queued again")],
  [/^the agent ended before the recording started; the run can be queued again$/, () => t("the agent ended before the recording started; the run can be queued again")],
  [/^the service or agent that executed the run ended$/, () => t("the service or agent that executed the run ended")],
  [/^no answer to '(?<question>.+)' within (?<seconds>\S+) s$/s, (of) => t("no answer to '{question}' within {seconds} s", of)],
  [/^beginning$/, () => t("beginning")],
  [/^its result is being stored$/, () => t("its result is being stored")],
  [/^its files are being uploaded$/, () => t("its files are being uploaded")],
  [/^its agent is not connected$/, () => t("its agent is not connected")],
  [/^run (?<run>\d+) of an earlier service process is being ended$/, (of) => t("run {run} of an earlier service process is being ended", of)],
  [/^stays in service: (?<holds>.+)$/s, ({ holds = "" }) => t("stays in service: {holds}", { holds: holds.split("; ").map((one) => wordsOfFirst(HOLDS, one) ?? one).join("; ") })],
  [/^(?<count>\d+) fields are wrong\n(?<lines>.+)$/s, ({ count = "", lines = "" }) => t("{count} fields are wrong", { count }) + lines.split("\n").map((line) => `\n  ${ofField(line.trim())}`).join("")],
  ...FIELD_REFUSALS,
  ...runPhrases(words),
  ...startPhrases(words),
  ...devicePhrases(words),
  ...judgingPhrases(words),
  ...REFUSALS,
  ...FILE_REFUSALS,
  ...FORM_WORDS,
  [/^emergency stop since (?<since>[^,]+), by (?<person>.+?): requested by .+$/, (of) => t("emergency stop since {since}, by {person}", { ...of, person: personIn(of["person"]) })],
];

// Why something is so may be another of these sentences, whatever it is a reason of.
const PHRASES = FORMS.map((phrase) => around(phrase, words, "reason", "why", "what", "words"));

// A line of several: the field, then what is wrong with it.
function ofField(line: string): string {
  const [, field = "", what = line] = /^(\S+) (.+)$/.exec(line) ?? [];
  const whole = wordsOfFirst(FIELD_REFUSALS, line), words = wordsOfFirst(FIELD_REFUSALS, what);
  return whole ?? (words === null ? line : `${field}: ${words}`);
}

// An error says what is wrong on its first line, and what to do on the next; an event has both on one.
export const linesOf = (text: string): string[] => (/^\d+ fields are wrong\n/.test(text) ? [text] : text.split(/(\n\s*| {3})/));

const KNOWN = new Map<string, string | null>(), MOST_KNOWN = 2000;

// Null for a sentence that is none of them; of a table of events many are alike.
export function translated(text: string): string | null {
  const known = KNOWN.get(text);
  if (known !== undefined) return known;
  const found = wordsOfFirst(PHRASES, text) ?? behindItsPlace(text) ?? ofAll(text);
  if (KNOWN.size >= MOST_KNOWN) KNOWN.clear();
  KNOWN.set(text, found);
  return found;
}

// Where a sentence says first what it is about, that stays, unless it is known too.
function behindItsPlace(text: string): string | null {
  const [, where = "", what = ""] = /^([^\n;]{1,120}?): (.+)$/s.exec(text) ?? [], known = what ? translated(what) : null;
  return known === null ? null : `${wordsOfFirst(PHRASES, where) ?? where}: ${known}`;
}

const HERE = [...pausePhrases((text) => atThePage(text)), ...PLACES];

// For readers of English, too: what the engine calls held is paused here, and a file of the service's machine a download.
export function atThePage(text: string): string {
  const found = wordsOfFirst(HERE, text);
  if (found !== null) return found;
  return text.includes("; ") ? text.split("; ").map(atThePage).join("; ") : text;
}

// A folder of the service's machine says nothing here; that of a run is a number, and the page is the run's. Ports stay.
export const withoutPlace = (line: string): string => line.replace(/^\/(?!dev\/)(?:[^/:\n]+\/)*([^/:\n]+): /, (_, name: string) => (/^\d+$/.test(name) ? "" : `${name}: `));

// Several sentences in one, if each of them is known.
function ofAll(text: string): string | null {
  if (!text.includes("; ")) return null;
  const parts = text.split("; ").map(translated);
  return parts.includes(null) ? null : parts.join("; ");
}
