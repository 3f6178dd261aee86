// What the operator is asked: the words, the picture beside them, and how long there is for an answer.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { API, post } from "../api/client.ts";
import { serviceNowMs } from "../api/clock.ts";
import type { Prompt } from "../api/types.ts";
import { attempt } from "../data.ts";
import { roughly } from "../format.ts";
import { t } from "../i18n/text.ts";
import { useMay } from "../session.ts";
import { LimitedField } from "../ui/too-long.tsx";

const LITTLE_S = 30;
export const LONGEST_ANSWER = 500;

// Whatever is typed is a remark: a "no" goes on, too, so that a button of its own says no.
// An answer reaches the run only while whoever drives its bench is there.
export function PromptCard({ prompt, run, reached }: { prompt: Prompt; run: number; reached: boolean }): JSX.Element {
  const may = useMay(), [text, setText] = useState("");
  const send = (event: Event) => {
    event.preventDefault();
    void attempt(() => post(`/runs/${run}/answer`, { text }).then(() => true)).then((taken) => { if (taken) setText(""); });
  };
  return (
    <section class="prompt" aria-label={t("Question")}>
      <div>
        <p class="asked" role="status">{prompt.text}</p>
        <Countdown until={prompt.answer_by} />
        {may("operator") && reached ? (
          <form class="row" onSubmit={send}>
            <LimitedField label={t("Remark")} most={LONGEST_ANSWER} value={text} onText={setText} />
            <button type="submit" class="main">{t("Continue")}</button>
            <button type="button" onClick={() => void attempt(() => post(`/runs/${run}/abort`))}>{t("Do not continue: end the run")}</button>
          </form>
        ) : null}
      </div>
      {prompt.picture ? <img src={`${API}/pictures/${encodeURIComponent(prompt.picture)}`} alt={t("Picture of the question: {file}", { file: prompt.picture })} /> : null}
    </section>
  );
}

// Without an answer in time the run ends.
function Countdown({ until }: { until: string }): JSX.Element {
  const left = Math.max(0, Math.round((Date.parse(until) - useNow()) / 1000));
  return (
    <p class={left <= LITTLE_S ? "countdown bad" : "countdown"} role="timer">
      {left > 0 ? t("{time} left to answer; then the run ends", { time: roughly(left) }) : t("The time for an answer is over.")}
    </p>
  );
}

// The service's clock, to the second.
export function useNow(): number {
  const [now, setNow] = useState(serviceNowMs);
  useEffect(() => {
    const timer = setInterval(() => setNow(serviceNowMs()), 1000);
    return () => clearInterval(timer);
  }, []);
  return now;
}
