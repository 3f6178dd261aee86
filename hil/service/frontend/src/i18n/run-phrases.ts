// What a run says of its limits, its pauses, its devices and the way to safety, known by its form.

import { wordsOf } from "../format.ts";
import { around, ofChannel, said, type Phrase, type Words } from "./said.ts";
import { t } from "./text.ts";

const RESPONSES: Record<string, string> = { warn: t("warning"), pause: t("pause"), hold: t("pause"), ramp_down: t("ramp down"), trip: t("trip"), emergency_stop: t("emergency stop") };

// The engine holds a run; at the page it is paused, in English too.
export const pausePhrases = (words: Words): Phrase[] => [
  [/^held, torque off, the dynos hold their speed: (?<cause>.+)$/s, ({ cause = "" }) => t("paused, torque off, the dynos hold their speed: {cause}", { cause: words(cause) })],
  [/^held: paused by the operator$/, () => t("paused by the operator")],
  [/^held: (?<cause>.+)$/s, ({ cause = "" }) => t("paused: {cause}", { cause: words(cause) })],
  [/^being ended: (?<doing>held: .+)$/s, ({ doing = "" }) => t("being ended: {doing}", { doing: words(doing) })],
  [/^(?<reached>.+); it has already held the run (?<count>\d+) times$/s, ({ reached = "", count = "" }) => t("{reached}; it has already paused the run {count} times", { reached: words(reached), count })],
  [/^(?<reached>.+): held, and there is no terminal to resume from$/s, ({ reached = "" }) => t("{reached}: paused, and there is no terminal to resume from", { reached: words(reached) })],
  [/^(?<reached>.+): held for (?<seconds>\S+) s$/s, ({ reached = "", seconds = "" }) => t("{reached}: paused for {seconds} s", { reached: words(reached), seconds })],
];

// What is at a place on the service's machine is a download or a button here, to readers of English too.
export const PLACES: Phrase[] = [
  [/^hil evidence recover .+ recovers the recording of what was measured$/, () => t("the recording of what was measured is among this run's files; once downloaded, hil evidence recover recording.mcap mends it")],
  [/^make them with: hil report .+$/, () => t("make them from the downloaded recording: hil report recording.mcap")],
  [/^make sure that no one is in danger, remove the cause; then: (?:reset it at its service, or: )?hil bench reset .+$/, () => t("make sure that no one is in danger and remove the cause; then reset it here")],
  [/^make sure that no one is in danger; then: (?:reset it at its service, or: )?hil bench reset .+$/, () => t("make sure that no one is in danger; then reset it here")],
  [/^check the file; then: (?:reset it at its service, or: )?hil bench reset .+$/, () => t("check the file on the service's machine; then reset it here")],
];

export const runPhrases = (words: Words): Phrase[] => [
  ...pausePhrases(words),
  ...PLACES,
  // sentences around others; the widest first
  around(said("limit tripped: {reached}"), words, "reached"),
  around(said("warning: {reached}"), words, "reached"),
  around(said("not yet: {reached}"), words, "reached"),
  around(said("being ended: {doing}"), words, "doing"),
  around(said("stopped before it began: {reason}"), words, "reason"),
  around(said("resumes after {seconds} s: {by}"), words, "by"),
  around(said("{what} (the bench loop was delayed by {seconds} s just before)"), words, "what"),
  // what may be its cause: the loop of the bench, or frames that came damaged
  [/^(?<what>.+?) \((?<why>(?:bus '|the bench loop was delayed by ).+)\)$/s, (of) => t("{what} ({why})", of)],
  around(said("{complaint}, while the axle ran down"), words, "complaint"),
  [/^(?<name>.+): (?<reached>.+); response: (?<response>\w+)$/, (of) => t("{name}: {reached}; response: {response}", { ...of, reached: words(of["reached"] ?? ""), response: RESPONSES[of["response"] ?? ""] ?? of["response"] ?? "" })],
  said("compiling for this machine, once: a minute or two"),
  // limits and what brings a channel back within them
  ofChannel(said("slope of {channel} reached {value}, the limit is {limit}"), "channel"),
  ofChannel(said("{channel} reached {value}, the limit is {limit}"), "channel"),
  said("lower the plan's torque or speed"),
  said("let it cool down and look at its cooling, or have the plan ask for less, or for less long"),
  said("look at what this channel measures, and at the plan's steps before it"),
  said("the limit is in the bench file"),
  said("see the recording's events"),
  said("the bench file has the limits and interlocks"),
  said("bench limits"),
  said("paused by the operator"),
  said("operator"),
  said("well again"),
  said("end of the run"),
  // what is no longer measured
  said("{stream} has stopped coming"),
  said("{stream} has stopped coming ({why})"),
  said("check its wiring and its sender"),
  said("is the device powered?"),
  said("{channel} repeats bit for bit for {time} ms, though it had noise before: it is no longer measured"),
  said("{channel} repeats bit for bit for {time} ms, while {witness} moves: it is no longer measured"),
  said("check the sensor, its amplifier and the end of its range"),
  said("the bench loop was delayed by {seconds} s, more than {most} s"),
  said("this computer"),
  said("close other programs, and record to a faster disk"),
  // devices
  said("the RMCU went to fault: {fault}"),
  said("the RMCU is in fault: {fault}"),
  said("the RMCU stays off, though torque is requested"),
  said("the RMCU did not switch off (state {name})"),
  said("the RMCU does not confirm that its torque is off: {why}"),
  said("check whether another host requests torque: hil bench monitor shows the frames"),
  said("the RMCU sends no status"),
  said("check that it is powered and on this bus"),
  said("check that the RMCU is powered and on this bus"),
  said("the RMCU's frames come with wrong checksums"),
  said("the RMCU's counter stands still"),
  around(said("{node}: heartbeat lost"), words, "node"),
  around(said("{node}: drive in fault"), words, "node"),
  said("no heartbeat from {nodes}"),
  said("switch the dyno controller on, check node ids in the bench file"),
  said("the rear dynos send no measured values"),
  said("reset the dyno controller and check its fault list"),
  said("the wheels turn at {speed} rad/s, {wanted} rad/s was requested"),
  said("check the dyno controller's torque limit"),
  said("interlock '{name}'"),
  [/^check (?<device>\S+)$/, (of) => t("check {device}", of)],
  // the way to safety
  said("safe state"),
  around(said("{device} did not confirm its safe state within {seconds} s"), words, "device"),
  around(said("{device} did not confirm its safe state within {seconds} s: {reason}"), words, "device"),
  around(said("{device} does not confirm that its torque is off"), words, "device"),
  said("cut the drives' power before you approach the bench"),
  said("the process that holds the bench"),
  said("hung: it sent nothing for {seconds} s"),
  said("hung: its loop was not running for {seconds} s"),
  said("was stopped (SIGSTOP) for {seconds} s"),
  said("was still opening the bench"),
  said("no longer responds"),
  said("has ended"),
  said("was ended by {signal}"),
  said("ended with code {code} without a message"),
  said("its process ended with code {code}"),
  said("nothing was commanded"),
  said("safe: confirmed"),
  [/^safe: not confirmed \((?<why>.+)\)$/s, (of) => t("safe: not confirmed ({why})", { why: words(of["why"] ?? "") })],
  said("not executed: nothing may move on a bench that has failed"),
  said("started, but not completed"),
  said("the command of this run has ended"),
  said("the command has been silent for {seconds} s"),
  // emergency stops
  said("the operator typed e"),
  said("an emergency stop may be latched here, but cannot be read"),
  said("it could NOT be latched, so nothing prevents arming the bench again: {reason}"),
  // sensors at rest
  said("zero check"),
  said("{channel} cannot be read at rest: {reason}"),
  said("{channel} reads {value} at rest, the bench file allows {allowed}"),
  said("{channel} has drifted by {value} during the run, the bench file allows {allowed}"),
  said("the results of this run are not reliable"),
  said("zero the sensor's amplifier, and check the shafts for locked-in torque"),
  said("the limit is under [zero] in the bench file"),
  [/^the axle turns: (?<channel>\S+) reads (?<speed>.+)$/, (of) => t("the axle turns: {channel} {speed}", { ...of, channel: wordsOf(of["channel"] ?? "") })],
  // questions, and who has confirmed
  said("operator prompt"),
  said("no operator: a simulated bench continues"),
  said("confirmed by the operator; remark: {answer}"),
  said("confirmed by the operator: {answer}"), // of earlier versions
  said("confirmed by the operator"),
  said("confirmed in advance by {person}"),
  // why a criterion has no value
  said("the segment ends {end} s after the step, the window needs {needed} s"),
  said("the window is empty"),
  said("{missing} of {count} samples of {channel} are missing in the window"),
  said("the recording has a gap of {seconds} s at {time} s"),
  said("the recording does not cover the window from {begin} s to {end} s"),
  said("segment '{segment}'"),
  said("coming up"),
];
