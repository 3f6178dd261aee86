// Duration, peaks and criteria of a plan as the service predicts them.

import type { JSX } from "preact";
import { useEffect, useState } from "preact/hooks";
import { ask, Refused } from "../../api/client.ts";
import type { Forecast } from "../../api/types.ts";
import { figure, percent, unitIn, wordsOf } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { Scroll } from "../../ui/parts.tsx";
import { Criteria } from "../criteria.tsx";

const WAIT_MS = 400;
const LONG_MS = 5000;

interface Wanted {
  plan: string;
  bench: string;
  values: Record<string, number>;
  text?: string; // of a plan that is not given yet
}

interface Foreseen {
  forecast: Forecast | null;
  error: string;
  wrong?: string; // why a typed value is not taken
  refused: boolean; // the service would not queue it either, or it exceeds the bench
}

const NOTHING: Foreseen = { forecast: null, error: "", refused: false };

// `wrong`: why a typed value is not taken; nothing is asked then.
export function useForecast(wanted: Wanted | null, wrong = ""): Foreseen {
  const [found, setFound] = useState(NOTHING);
  const key = JSON.stringify([wanted, wrong]);
  useEffect(() => {
    setFound({ ...NOTHING, wrong, refused: wrong !== "" });
    if (!wanted || wrong) return undefined;
    const control = new AbortController();
    const predict = async () => {
      try {
        const forecast = await ask<Forecast>("POST", "/forecasts", wanted, control.signal);
        setFound({ forecast, error: "", refused: !forecast.fits });
      } catch (error) {
        if (control.signal.aborted) return;
        const { message } = error as Error, fix = error instanceof Refused ? error.fix : "";
        // what cannot be predicted may still be run
        setFound({ forecast: null, error: fix ? `${message} (${fix})` : message, refused: !(error instanceof Refused && (error.status === 503 || error.status === 0)) });
      }
    };
    const timer = setTimeout(() => void predict(), WAIT_MS);
    return () => { control.abort(); clearTimeout(timer); };
  }, [key]);
  return found;
}

// Nobody has to wait for it: a run is queued while it is computed, and a run that exceeds its bench is refused there.
// With criteria it says what each is predicted to be, else how many fail.
export function ForecastShown({ of: { forecast, error, wrong }, criteria = false }: { of: Foreseen; criteria?: boolean }): JSX.Element {
  if (wrong) return <p class="bad">{wrong}</p>;
  if (error) return <p class="bad"><English>{error}</English></p>;
  if (!forecast) return <Predicting />;
  const failing = forecast.criteria.filter((one) => one.verdict === "fail").length;
  const loads = Object.entries(forecast.bus_loads ?? {});
  return (
    <>
      <p class={forecast.fits ? "" : "bad"}>{t("About {seconds} s of bench time.", { seconds: Math.round(forecast.duration_s) })} {forecast.fits ? t("Fits the bench.") : t("It exceeds the limits of the bench and cannot be queued.")}</p>
      {loads.length ? <p class={loads.some(([, load]) => load > 1) ? "bad" : ""}>{t("Largest loads of the buses: {loads}.", { loads: loads.map(([bus, load]) => `${bus} ${percent(load)}`).join(", ") })}</p> : null}
      {failing ? <p class="bad">{t("Criteria predicted to fail: {failing} of {all}.", { failing, all: forecast.criteria.length })}</p> : null}
      {criteria && forecast.criteria.length ? <Criteria of={forecast.criteria} /> : null}
      <Scroll label={t("Predicted peaks")}>
        <table>
          <thead><tr><th scope="col">{t("predicted")}</th><th scope="col" class="number">{t("peak")}</th><th scope="col" class="number">{t("limit")}</th><th scope="col" class="number">{t("used")}</th></tr></thead>
          <tbody>
            {Object.entries(forecast.predicted).map(([name, { value, limit }]) => (
              <tr key={name}><th scope="row" title={name}>{wordsOf(name)}</th><td class={value > limit ? "number bad" : "number"}>{figure(value, unitIn(name))}</td><td class="number">{figure(limit, unitIn(name))}</td><td class="number">{percent(value / limit)}</td></tr>
            ))}
          </tbody>
        </table>
      </Scroll>
    </>
  );
}

function Predicting(): JSX.Element {
  const [long, setLong] = useState(false);
  useEffect(() => {
    const timer = setTimeout(() => setLong(true), LONG_MS);
    return () => clearTimeout(timer);
  }, []);
  return <p class="quiet">{t("Predicting duration and peaks …")}{long ? ` ${t("The first prediction on a machine compiles the simulation: a minute or two.")}` : ""}</p>;
}
