// One bench: what it does, its run as it goes on, its queue, the form that starts a plan.

import type { JSX } from "preact";
import { useEffect } from "preact/hooks";
import { to } from "../addresses.ts";
import { useLive } from "../live.ts";
import { useMay } from "../session.ts";
import { benchInSight } from "../shell/stop.tsx";
import { useStore } from "../store.ts";
import { Section } from "../ui/parts.tsx";
import { Banner, LostNotice } from "./bench-banner.tsx";
import { Queue } from "./queue.tsx";
import { StartPlan } from "./start-plan.tsx";

export function BenchView({ bench }: { bench: string }): JSX.Element {
  const live = useLive(bench);
  const state = useStore(live.state);
  const may = useMay();
  useEffect(() => { benchInSight.value = bench; }, [bench]);
  return (
    <>
      <LostNotice />
      {state ? <Banner state={state} level={1} /> : <h1>{bench}</h1>}
      <div class="columns">
        <div>
        </div>
        <div>
          <Section title="Queue" label="queue">{state ? <Queue runs={state.queue} /> : null}</Section>
          {may("operator") ? <Section title="Start a plan" label="start"><StartPlan bench={bench} /></Section> : null}
          <p><a href={to.panel(bench)}>Operator panel</a></p>
        </div>
      </div>
    </>
  );
}
