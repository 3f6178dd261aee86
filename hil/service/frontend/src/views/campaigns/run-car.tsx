// A car of a campaign becomes a bench of the service: its model, bench file, controller and plan are given, and a run waits there.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { ask, get, post } from "../../api/client.ts";
import type { Run, SimulationFiles } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, useData } from "../../data.ts";
import { t } from "../../i18n/text.ts";
import { go } from "../../router.ts";
import { Badge, verdictOf } from "../../ui/parts.tsx";

const AGAIN_MS = 3000;

export const benchOf = (campaign: number, simulation: number): string => `campaign-${campaign}-car-${simulation}`;

// The newest runs of cars of a campaign, by their benches.
export function useCarRuns(campaign: number): Map<string, Run> {
  const runs = useData<Run[]>("/runs?most=200", AGAIN_MS).data ?? [];
  const found = new Map<string, Run>();
  for (const run of runs) if (run.bench.startsWith(benchOf(campaign, 0).slice(0, -1)) && !found.has(run.bench)) found.set(run.bench, run);
  return found;
}

// As anybody gives files and queues a run; what is there already stays as it is.
async function queueCar(campaign: number, simulation: number): Promise<Run> {
  const { name, model_name: axle, model, bench, plan, controller } = await get<SimulationFiles>(`/campaigns/${campaign}/simulations/${simulation}`);
  await ask("PUT", `/models/${axle}`, model);
  await ask("PUT", `/bench-files/${name}`, bench);
  await ask("PUT", `/bench-files/${name}/service`);
  if (controller !== null) await ask("PUT", `/controllers/${name}`, controller);
  await ask("PUT", `/plans/${name}`, plan);
  return post<Run>("/runs", { plan: name, bench: name });
}

export function RunCar({ campaign, simulation, run }: { campaign: number; simulation: number; run: Run | undefined }): JSX.Element {
  const [busy, setBusy] = useState(false);
  const queue = async () => {
    setBusy(true);
    const queued = await attempt(() => queueCar(campaign, simulation));
    setBusy(false);
    if (queued) go(to.run(queued.id));
  };
  return (
    <>
      {run ? <><a href={to.run(run.id)}>{t("run {run}", { run: run.id })}</a> <Badge kind={verdictOf(run)} /> </> : null}
      <button type="button" disabled={busy} aria-label={t("Run car {number} on a simulated bench", { number: simulation })} onClick={() => void queue()}>{run ? t("Run again") : t("Run")}</button>
    </>
  );
}
