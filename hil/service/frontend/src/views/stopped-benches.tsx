// Above every view that is not the bench's own: which benches an emergency stop holds, until it is reset.

import type { JSX } from "preact";
import type { Bench } from "../api/types.ts";
import { to, type Place } from "../addresses.ts";
import { useData } from "../data.ts";
import { English } from "../i18n/english.tsx";
import { t, tx } from "../i18n/text.ts";
import { benchInSight } from "../shell/stop.tsx";
import { useStore } from "../store.ts";
import { linkTo } from "../ui/parts.tsx";

const AGAIN_MS = 2000;

const isHeldByStop = (bench: Bench): boolean => bench.state === "emergency_stop" || bench.stop_confirmed === false;

// The list of benches shows the state of each, and the views of a bench or of its run that of theirs.
export function StoppedBenches({ place }: { place: Place }): JSX.Element {
  const inSight = useStore(benchInSight), own = "bench" in place ? place.bench : inSight;
  const benches = useData<Bench[]>(place.view === "benches" ? null : "/benches", AGAIN_MS).data ?? [];
  return <div aria-live="assertive">{benches.filter((one) => isHeldByStop(one) && one.name !== own).map((bench) => <StoppedBench key={bench.name} bench={bench} />)}</div>;
}

export function StoppedBench({ bench }: { bench: Bench }): JSX.Element | null {
  if (!isHeldByStop(bench)) return null;
  const shown = { bench: bench.name, a: linkTo(to.bench(bench.name)) };
  return (
    <section class="banner emergency_stop" aria-label={t("Emergency stop of {bench}", { bench: bench.name })}>
      <p class="lead">{bench.stop_confirmed === false
        ? tx("The emergency stop of <a>{bench}</a> was sent, but the bench has NOT CONFIRMED it. Use the stop at the bench.", shown)
        : tx("<a>{bench}</a> is stopped: its emergency stop stays until it is reset there.", shown)}</p>
      {bench.why ? <p><English>{bench.why}</English></p> : null}
    </section>
  );
}
