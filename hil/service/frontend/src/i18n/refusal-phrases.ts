// Refusals of the service at runs, benches and their queues, and what it says to do then, known by their form.

import { kindInWords } from "../ui/kinds.ts";
import { t } from "./text.ts";

type Said = Record<string, string>;

export const REFUSALS: [RegExp, (of: Said) => string][] = [
  [/^a second person approves it$/, () => t("a second person approves it")],
  [/^(?<who>.+) is (?<has>viewer|operator|engineer|admin|agent); (?<role>viewer|operator|engineer|admin|agent) is needed$/, (of) => t("{who} has the role {has}; the role {role} is needed", { ...of, has: kindInWords(of["has"] ?? ""), role: kindInWords(of["role"] ?? "") })],
  [/^ask an administrator for the role$/, () => t("ask an administrator for the role")],
  [/^ask them or an administrator$/, () => t("ask them or an administrator")],
  [/^ask an engineer$/, () => t("ask an engineer")],
  [/^a run is still being ended$/, () => t("a run is still being ended")],
  [/^a run is under way there$/, () => t("a run is under way there")],
  [/^wait for its end$/, () => t("wait for its end")],
  [/^another user holds the bench$/, () => t("another user holds the bench")],
  [/^wait until it is released$/, () => t("wait until it is released")],
  [/^(?<who>.+) holds the bench until (?<end>[\d-]+ [\d:]+ UTC)$/, (of) => t("{who} has the bench until {end}", of)],
  [/^(?<who>.+) holds the bench$/, (of) => t("{who} has the bench", of)],
  [/^(?<who>.+) has reserved the bench from (?<begin>[\d-]+ [\d:]+ UTC) to (?<end>[\d-]+ [\d:]+ UTC): (?<reason>.*)$/s, (of) => t("{who} has reserved the bench from {begin} to {end}: {reason}", of)],
  [/^choose another time$/, () => t("choose another time")],
  [/^run (?<run>\d+) does not wait for approval$/, (of) => t("run {run} does not wait for approval", of)],
  [/^run (?<run>\d+) is finished$/, (of) => t("run {run} is finished", of)],
  [/^run (?<run>\d+) is no longer queued$/, (of) => t("run {run} is no longer queued", of)],
  [/^run (?<run>\d+) is not active$/, (of) => t("run {run} is not under way", of)],
  [/^run (?<run>\d+) belongs to another service$/, (of) => t("run {run} belongs to another service", of)],
  [/^the reservation is (?<who>.+)'s$/, (of) => t("the reservation is {who}'s", of)],
  [/^the note is (?<who>.+)'s$/, (of) => t("the note is {who}'s", of)],
  [/^its agent does not answer$/, () => t("its agent does not answer")],
  [/^check that the agent is running$/, () => t("check that the agent is running")],
  [/^it can be ended; its agent gets the order when it reconnects$/, () => t("it can be ended; its agent gets the order when it reconnects")],
  [/^there is no (?<kind>bench|plan|run|model|controller) '(?<name>.+)'$/, (of) => t("there is no {kind} '{name}'", { ...of, kind: kindInWords(of["kind"] ?? "") })],
  [/^emergency stop: requested by (?<who>.+?) from (?<place>\S+?)(?: .*)?$/, (of) => t("emergency stop, requested by {who} from {place}", of)],
  [/^emergency stop: requested by (?<who>.+?)(?: over the service's API| at the service's page| on the service's page)?$/, (of) => t("emergency stop, requested by {who}", of)],
  [/^make sure that no one is in danger; then: reset it at its service, or: (?<command>hil bench reset .+)$/, (of) => t("make sure that no one is in danger; then reset it here, or with {command}", of)],
  [/^segment '(?<segment>[^']+)' was not run$/, (of) => t("segment '{segment}' was not run", of)],
  [/^segment '(?<segment>[^']+)' was stopped after (?<seconds>\S+) s$/, (of) => t("segment '{segment}' was stopped after {seconds} s", of)],
];
