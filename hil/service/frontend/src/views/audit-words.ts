// Entries of the audit log in the reader's words; names, and what people said, stay as they are.

import { duration, figuresIn } from "../format.ts";
import { withLocalMoments } from "../i18n/local-moments.ts";
import { wordsOf, type Phrase } from "../i18n/said.ts";
import { t, tn } from "../i18n/text.ts";

const TARGETS: Phrase[] = [
  [/^run (?<run>\d+)$/, (of) => t("run {run}", of)],
  [/^campaign (?<number>\d+)$/, (of) => t("campaign {number}", of)],
  [/^recording (?<number>\d+)$/, (of) => t("recording {number}", of)],
  [/^study (?<number>\d+)$/, (of) => t("study {number}", of)],
];

const DETAILS: Phrase[] = [
  [/^(?<seconds>[0-9]+(?:\.[0-9]+)?) s$/, (of) => duration(Number(of["seconds"]))],
  [/^(?<count>\d+) stops?$/, (of) => tn("{count} stop", "{count} stops", Number(of["count"]))],
  [/^(?<plan>[\w.-]+) on (?<bench>[\w.-]+)$/, (of) => t("{plan} on {bench}", of)],
  [/^(?<plan>[\w.-]+) on (?<bench>[\w.-]+), (?<values>\w+ = .+)$/, ({ values = "", ...of }) => `${t("{plan} on {bench}", of)}, ${figuresIn(values)}`],
];

export const targetOf = (text: string): string => wordsOf(TARGETS, text) ?? text;
export const detailOf = (text: string): string => wordsOf(DETAILS, text) ?? withLocalMoments(text);
