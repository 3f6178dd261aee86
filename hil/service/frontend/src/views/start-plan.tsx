// The form that starts a plan: what it will do is predicted first.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { post, Refused } from "../api/client.ts";
import type { Bench, Forecast, Plan, Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { attempt, useData } from "../data.ts";
import { figure, percent } from "../format.ts";
import { go } from "../router.ts";
import { Scroll } from "../ui/parts.tsx";

const WAIT_MS = 400;

interface Wanted {
  plan: string;
  bench: string;
  values: Record<string, number>;
}

// Either the bench is given, or the plan; the other is chosen.
export function StartPlan({ bench, plan }: { bench?: string; plan?: string }): JSX.Element {
  const plans = useData<Plan[]>("/plans").data ?? [];
  const benches = useData<Bench[]>(bench ? null : "/benches").data ?? [];
  const [chosenPlan, setPlan] = useState(plan ?? "");
  const [chosenBench, setBench] = useState(bench ?? "");
  const [texts, setTexts] = useState<Record<string, string>>({});
  const form = useRef<HTMLFormElement>(null);
  const found = plans.find((one) => one.name === (chosenPlan || plans[0]?.name));
  const where = chosenBench || benches[0]?.name || "";
  const values = Object.fromEntries(Object.entries(found?.variables ?? {}).map(([name, { default: usual }]) => [name, Number(texts[name] ?? usual)]));
  const wanted = found && where ? { plan: found.name, bench: where, values } : null;
  const forecast = useForecast(wanted, form);
  const start = async (event: Event) => {
    event.preventDefault();
    if (!wanted) return;
    const run = await attempt(() => post<Run>("/runs", { ...wanted, key: crypto.randomUUID?.() ?? "" }));
    if (run) go(to.run(run.id));
  };
  return (
    <form ref={form} class="start" onSubmit={(event) => void start(event)}>
      {plan ? null : (
        <label class="field">Plan
          <select value={found?.name ?? ""} onChange={(event) => { setPlan(event.currentTarget.value); setTexts({}); }}>
            {plans.map((one) => <option key={one.name} value={one.name}>{one.title || one.name}</option>)}
          </select>
        </label>
      )}
      {bench ? null : (
        <label class="field">Bench
          <select value={where} onChange={(event) => setBench(event.currentTarget.value)}>
            {benches.map((one) => <option key={one.name} value={one.name}>{one.name}</option>)}
          </select>
        </label>
      )}
      {plan || !found ? null : <p class="quiet"><a href={to.plan(found.name)}>{found.name}</a>{found.description ? `: ${found.description}` : ""}</p>}
      {Object.entries(found?.variables ?? {}).map(([name, variable]) => (
        <label class="field" key={`${found?.name} ${name}`}>{`${variable.description || name}${variable.unit ? ` in ${variable.unit}` : ""}`}
          <input type="number" step="any" required name={name} value={texts[name] ?? String(variable.default)} min={variable.lower ?? undefined} max={variable.upper ?? undefined}
            onInput={(event) => setTexts({ ...texts, [name]: event.currentTarget.value })} />
        </label>
      ))}
      <div class="forecast" aria-live="polite"><ForecastShown of={forecast} /></div>
      <button type="submit" class="main" disabled={!forecast.may}>Queue the run</button>
    </form>
  );
}

interface Foreseen {
  forecast: Forecast | null;
  error: string;
  may: boolean;
}

const NOTHING: Foreseen = { forecast: null, error: "", may: false };

function useForecast(wanted: Wanted | null, form: { current: HTMLFormElement | null }): Foreseen {
  const [found, setFound] = useState(NOTHING);
  const key = JSON.stringify(wanted);
  useEffect(() => {
    setFound(NOTHING);
    if (!wanted) return undefined;
    let current = true;
    const predict = async () => {
      try {
        if (!form.current?.checkValidity()) throw new Error("A variable is beyond its bounds.");
        const forecast = await post<Forecast>("/forecasts", wanted);
        if (current) setFound({ forecast, error: "", may: forecast.fits });
      } catch (error) {
        const { message } = error as Error, fix = error instanceof Refused ? error.fix : "";
        // what cannot be predicted may still be run
        if (current) setFound({ forecast: null, error: fix ? `${message} (${fix})` : message, may: error instanceof Refused && error.status === 503 });
      }
    };
    const timer = setTimeout(() => void predict(), WAIT_MS);
    return () => { current = false; clearTimeout(timer); };
  }, [key]);
  return found;
}

function ForecastShown({ of: { forecast, error } }: { of: Foreseen }): JSX.Element {
  if (error) return <p class="bad">{error}</p>;
  if (!forecast) return <p class="quiet">Predicting duration and peaks …</p>;
  const failing = forecast.criteria.filter((one) => one.verdict === "fail").length;
  const loads = Object.entries(forecast.bus_loads ?? {});
  return (
    <>
      <p class={forecast.fits ? "" : "bad"}>{`About ${Math.round(forecast.duration_s)} s of bench time. ${forecast.fits ? "Fits the bench." : "It exceeds the limits of the bench and cannot be queued."}`}</p>
      {loads.length ? <p class={loads.some(([, load]) => load > 1) ? "bad" : ""}>{`Load of the buses: ${loads.map(([bus, load]) => `${bus} at most ${percent(load)}`).join(", ")}.`}</p> : null}
      {failing ? <p class="bad">{`${failing} of ${forecast.criteria.length} criteria are predicted to fail.`}</p> : null}
      <Scroll label="Predicted peaks">
        <table>
          <thead><tr><th scope="col">predicted</th><th scope="col" class="number">peak</th><th scope="col" class="number">limit</th><th scope="col" class="number">used</th></tr></thead>
          <tbody>
            {Object.entries(forecast.predicted).map(([name, { value, limit }]) => (
              <tr key={name}><th scope="row">{name}</th><td class={value > limit ? "number bad" : "number"}>{figure(value)}</td><td class="number">{figure(limit)}</td><td class="number">{percent(value / limit)}</td></tr>
            ))}
          </tbody>
        </table>
      </Scroll>
    </>
  );
}
