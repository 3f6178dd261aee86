// The page's words, each in a sentence: as docs/reference/glossary.md has them.

import type { JSX } from "preact";
import { t } from "../i18n/text.ts";
import { Heading } from "../ui/parts.tsx";
import { meaningOf, METRIC_NAMES, metricWords } from "./criterion-words.ts";

const WORDS: [string, string][] = [
  [t("Bench"), t("what a run is executed on: RMCU, dynos and their buses, or their simulation")],
  [t("Plan"), t("steps, end steps and criteria of a test; variables have values of their own for each run")],
  [t("A run"), t("a plan executed once on a bench, with its recording, its verdict and its report")],
  [t("Segment"), t("a named stretch of a run, from before a step until after it, in which criteria are judged")],
  [t("Criterion"), t("a metric of a segment, and the limits that it must keep")],
  [t("Margin"), t("distance of a value to the nearest limit as a share of that limit; negative beyond it")],
  [t("Of any device"), t("a check that every device must pass, whatever its plan asks: the torque arrives in time, stays, and does not swing")],
  [t("Verdict"), t("pass or fail by the criteria; error where a run was stopped or could not be judged; done where no criterion has a limit")],
  [t("Undecided"), t("two values nearer to each other than their own scatter; it fails the run")],
  [t("Safe state"), t("torque off and drives disabled, as the devices themselves confirm it")],
  [t("Emergency stop"), t("makes a bench safe at once and stays latched until an engineer resets it; it does not replace the hardwired one")],
  [t("Paused"), t("a run stands still with the torque off until its cause is gone or an operator lets it go on")],
  [t("Reservation"), t("a bench belongs to one person from a moment to another; runs of others wait meanwhile")],
  [t("Agent"), t("drives the benches of another machine for this service")],
  [t("Forecast"), t("a plan computed on the bench's model: its duration, peaks and criteria, without moving anything")],
  [t("Gain stabilization"), t("a notch takes the axle's resonance out of the loop")],
  [t("Phase stabilization"), t("a lead gives the loop the right phase at the axle's resonance and damps it")],
  [t("Identification"), t("parameters of a model from recordings")],
  [t("Diagnosis"), t("which physical effect a model lacks, or that this cannot be said")],
  [t("Tuning"), t("parameters of a controller for which the criterion nearest to its limit has the most room")],
  [t("Campaign"), t("many simulations of a plan on cars that differ, and how often it passes")],
];

export function Glossary(): JSX.Element {
  return (
    <>
      <Heading>{t("Words of this page")}</Heading>
      <Words of={WORDS} />
      <h2>{t("Metrics")}</h2>
      <Words of={METRIC_NAMES.map((name): [string, string, string] => [metricWords(name), meaningOf(name), name])} />
    </>
  );
}

const Words = ({ of }: { of: [string, string, string?][] }): JSX.Element => (
  <dl class="meanings words">{of.map(([word, meaning, name]) => <div key={name ?? word}><dt>{word} {name ? <code>{name}</code> : null}</dt><dd>{meaning}</dd></div>)}</dl>
);
