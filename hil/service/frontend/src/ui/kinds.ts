// States, verdicts, roles and other names of the service in words.

import { t } from "../i18n/text.ts";

const KINDS: Record<string, string> = {
  pass: t("pass"), fail: t("fail"), error: t("error"), done: t("done"), undecided: t("undecided"), informational: t("informational"), did_not_settle: t("did not settle"), not_judged: t("not judged"),
  waiting_approval: t("waiting approval"), queued: t("queued"), waiting: t("waiting"), running: t("running"), stopping: t("stopping"), ended: t("ended"), interrupted: t("interrupted"), cancelled: t("cancelled"), failed: t("failed"), stopped: t("stopped"), ended_early: t("ended early"),
  viewer: t("viewer"), operator: t("operator"), engineer: t("engineer"), admin: t("admin"), agent: t("agent"),
  arriving: t("arriving"), checking: t("checking"), ready: t("ready"), refused: t("refused"),
  bench: t("bench"), plan: t("plan"), model: t("model"), controller: t("controller"), diagnosis: t("diagnosis"), identification: t("identification"), transfer_function: t("transfer function"), physical: t("physical"),
  tuning: t("tuning"), autotuning: t("autotuning"), linear: t("linear"), doubtful: t("doubtful"), stable: t("stable"), unstable: t("unstable"), segment: t("segment"), event: t("event"), hold: t("pause"),
  run: t("run"), note: t("note"), tag: t("tag"), recording: t("recording"), study: t("study"), campaign: t("campaign"), file: t("file"), version: t("version"), reservation: t("reservation"), person: t("person"), "valid token": t("valid token"),
  "given plan": t("given plan"), "given model": t("given model"), "given controller": t("given controller"), "given bench file": t("given bench file"), "bench of this service": t("bench of this service"), "bench of a bench file": t("bench of a bench file"), "bench of an agent": t("bench of an agent"),
  free: t("free"), ending: t("ending"), in_use: t("in use"), emergency_stop: t("emergency stop"), away: t("away"), open: t("open"), named: t("named"), unknown: t("unknown"), none: t("none"), picture: t("picture"), phase: t("phase"), gain: t("gain"),
};

// Kinds of events in recordings; a device's own are shown by their names.
const EVENTS: Record<string, string> = {
  preflight: t("pre-flight check"), arm: t("drives enabled"), controller: t("controller"), speed: t("speed"), slip: t("slip"), vehicle: t("vehicle"), prompt: t("question"), segment: t("segment"), analysis: t("analysis"),
  hold: t("pause"), held: t("pause"), limit: t("limit reached"), pause: t("delay of the loop"), late: t("late samples"), missing: t("missing"), bus: t("bus"), replay: t("replay"),
  emergency_stop: t("emergency stop"), failure: t("failure"), interrupt: t("ended early"), traceback: t("program fault"), end_steps: t("end steps"), safe_state: t("safe state"), run_down: t("run-down"),
};

// What people and agents did, as the audit log has it.
const ACTIONS: Record<string, string> = {
  queue: t("queued a run"), abort: t("ended a run"), answer: t("answered"), approve: t("approved"), pause: t("paused"), resume: t("resumed"), priority: t("changed a priority"),
  "emergency stop": t("emergency stop"), reset: t("reset the emergency stop"), lease: t("took the bench"), "lease given back": t("gave the bench back"), "agent let go": t("released an agent"),
  "plan given": t("plan given"), "plan removed": t("plan removed"), "model given": t("model given"), "model removed": t("model removed"), "controller given": t("controller given"), "controller removed": t("controller removed"),
  "bench file given": t("bench file given"), "bench file removed": t("bench file removed"), "bench put into service": t("bench put into service"), "bench taken out of service": t("bench taken out of service"),
  "recording given": t("recording given"), "recording read anew": t("recording read anew"), "recording removed": t("recording removed"), "picture given": t("picture given"), "picture removed": t("picture removed"),
  "note added": t("note added"), "note removed": t("note removed"), "tag added": t("tag added"), "tag removed": t("tag removed"), campaign: t("began a campaign"), "campaign cancelled": t("campaign cancelled"), "campaign removed": t("campaign removed"), "campaign resumed": t("campaign resumed"),
  "study cancelled": t("study cancelled"), "study removed": t("study removed"), identification: t("identification"), diagnosis: t("diagnosis"), tuning: t("tuning"), autotuning: t("autotuning"),
  reserve: t("reserved the bench"), "reservation removed": t("reservation removed"), "run admitted": t("run admitted"), "hand-over": t("note for the next shift"), "bench registered": t("bench registered"), take: t("run taken"), "sign in refused": t("sign-in refused"),
  "log in": t("signed in"), "sign in": t("signed in"), "signed out": t("signed out"), "token made": t("token made"), "token revoked": t("token revoked"), "run delivered": t("run delivered"), "run not taken": t("run not taken"), service: t("service"),
};

export const inWords = (name: string): string => name.replaceAll("_", " ");

export const kindInWords = (name: string): string => KINDS[name] ?? inWords(name);

export const eventInWords = (name: string): string => EVENTS[name] ?? inWords(name);

export const actionInWords = (name: string): string => ACTIONS[name] ?? inWords(name);

export const isKind = (name: string): boolean => name in KINDS;
