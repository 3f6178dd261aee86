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

export const inWords = (name: string): string => name.replaceAll("_", " ");

export const kindInWords = (name: string): string => KINDS[name] ?? inWords(name);
