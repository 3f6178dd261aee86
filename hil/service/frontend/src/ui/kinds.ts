// States, verdicts, roles and other names of the service in words.

import { t } from "../i18n/text.ts";

const KINDS: Record<string, string> = {
  pass: t("pass"), fail: t("fail"), error: t("error"), done: t("done"), undecided: t("undecided"),
  waiting_approval: t("waiting approval"), queued: t("queued"), waiting: t("waiting"), running: t("running"), stopping: t("stopping"), ended: t("ended"), interrupted: t("interrupted"), cancelled: t("cancelled"), failed: t("failed"),
  viewer: t("viewer"), operator: t("operator"), engineer: t("engineer"), admin: t("admin"), agent: t("agent"),
  arriving: t("arriving"), checking: t("checking"), ready: t("ready"), refused: t("refused"),
  bench: t("bench"), plan: t("plan"), model: t("model"), controller: t("controller"), diagnosis: t("diagnosis"), identification: t("identification"), transfer_function: t("transfer function"), physical: t("physical"),
  tuning: t("tuning"), autotuning: t("autotuning"), linear: t("linear"), doubtful: t("doubtful"), stable: t("stable"), unstable: t("unstable"), segment: t("segment"), event: t("event"), hold: t("hold"),
};

// Kinds of events in recordings; a device's own are shown by their names.
const EVENTS: Record<string, string> = {
  preflight: t("pre-flight check"), arm: t("drives enabled"), controller: t("controller"), speed: t("speed"), slip: t("slip"), vehicle: t("vehicle"), prompt: t("question"), segment: t("segment"), analysis: t("analysis"),
  hold: t("hold"), held: t("hold"), limit: t("limit reached"), pause: t("delay of the loop"), late: t("late samples"), missing: t("missing"), bus: t("bus"), replay: t("replay"),
  emergency_stop: t("emergency stop"), failure: t("failure"), interrupt: t("ended early"), traceback: t("program fault"), end_steps: t("end steps"), safe_state: t("safe state"),
};

export const inWords = (name: string): string => name.replaceAll("_", " ");

export const kindInWords = (name: string): string => KINDS[name] ?? inWords(name);

export const eventInWords = (name: string): string => EVENTS[name] ?? inWords(name);
