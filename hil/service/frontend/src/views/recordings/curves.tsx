// Curves of a recording, over them those of another one, or of a model that its torque drives.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import type { Model, Recording, RecordingCurve, RecordingCurves } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { useData } from "../../data.ts";
import { percent, wordsOf } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { roleOf } from "../../plot/frame.ts";
import { CurvePlot, type Curve } from "../../plot/curve-plot.tsx";
import { useMay } from "../../session.ts";
import { NumberInput } from "../../ui/number-field.tsx";

const USUAL = ["motor_torque_ref_nm", "motor_speed_rad_s", "shaft_torque_nm", "wheel_speed_rad_s"];
const MOST = 6;

export function Curves({ recording, others }: { recording: Recording; others: Recording[] }): JSX.Element {
  const names = (recording.channels ?? []).map((one) => one.name).filter((name) => name !== "time_s");
  const [channels, setChannels] = useState(() => { const usual = USUAL.filter((one) => names.includes(one)); return usual.length ? usual : names.slice(0, 2); });
  const [other, setOther] = useState(""), [model, setModel] = useState(""), [from, setFrom] = useState(""), [until, setUntil] = useState("");
  const may = useMay(), models = (useData<Model[]>("/models").data ?? []).map((one) => one.name);
  const stretch = [["start_s", from], ["end_s", until]].filter(([, text]) => text !== "" && Number.isFinite(Number(text))) as [string, string][];
  const query = (asked: [string, string][]) => new URLSearchParams([...asked, ...stretch]).toString();
  const mine = useData<RecordingCurves>(channels.length ? `/recordings/${recording.id}/curves?${query(channels.map((one) => ["channel", one]))}` : null);
  const there = useData<Recording>(other ? `/recordings/${other}` : null).data, shared = channels.filter((name) => there?.channels?.some((one) => one.name === name));
  const theirs = useData<RecordingCurves>(shared.length ? `/recordings/${other}/curves?${query(shared.map((one) => ["channel", one]))}` : null);
  const simulated = useData<RecordingCurves>(model ? `/recordings/${recording.id}/simulation?${query([["model", model]])}` : null);
  const turn = (name: string, on: boolean) => setChannels(on ? [...channels, name].slice(-MOST) : channels.filter((one) => one !== name));
  const failed = [mine, theirs, simulated].find((one) => one.error)?.error;
  return (
    <>
      <div class="filters">
        <label class="field">{t("Another recording over it")}<select value={other} onChange={(event) => setOther(event.currentTarget.value)}><option value="">{t("none")}</option>{others.map((one) => <option key={one.id} value={one.id}>{`${one.id}: ${one.name}`}</option>)}</select></label>
        {may("engineer") ? <label class="field">{t("Model driven by its torque")}<select value={model} onChange={(event) => setModel(event.currentTarget.value)}><option value="">{t("none")}</option>{models.map((one) => <option key={one}>{one}</option>)}</select></label> : null}
        <label class="field">{t("From, s")}<NumberInput rested value={from} onText={setFrom} /></label>
        <label class="field">{t("Until, s")}<NumberInput rested value={until} onText={setUntil} /></label>
      </div>
      <details><summary>{t("Channels that are shown")}</summary><div class="halves">{names.map((name) => <label class="tick" key={name}><input type="checkbox" checked={channels.includes(name)} onChange={(event) => turn(name, event.currentTarget.checked)} />{name}</label>)}</div></details>
      {failed ? <p class="bad" role="alert"><English>{failed.message}</English></p> : null}
      {model && simulated.loading ? <p class="quiet" role="status">{t("It is being simulated …")}</p> : null}
      <div class="plots">{(mine.data?.curves ?? []).map((one) => <Plot key={one.channel} of={one} name={recording.name} among={mine.data!} theirs={theirs.data} otherName={there?.name ?? ""} simulated={simulated.data} model={model} />)}</div>
      {(simulated.data?.notes ?? []).map((note) => <p class="quiet" key={note}><English>{note}</English></p>)}
      {model && simulated.data ? <p class="links"><a href={`${to.list("diagnoses")}?recordings=${recording.id}&model=${model}`}>{t("Diagnose why they differ")}</a></p> : null}
    </>
  );
}

interface PlotOptions {
  of: RecordingCurve;
  name: string;
  among: RecordingCurves;
  theirs: RecordingCurves | null;
  otherName: string;
  simulated: RecordingCurves | null;
  model: string;
}

function Plot({ of, name, among, theirs, otherName, simulated, model }: PlotOptions): JSX.Element {
  const other = theirs?.curves.find((one) => one.channel === of.channel), made = simulated?.curves.find((one) => one.channel === of.channel);
  const curves = useMemo(() => [
    curveOf(of, among, name, 0), ...(other && theirs ? [curveOf(other, theirs, otherName, 1)] : []), ...(made && simulated ? [curveOf(made, simulated, model, 2)] : []),
  ], [of, other, made]);
  const gap = made?.gap == null ? "" : t("gap to the model {share}", { share: percent(made.gap, 1) });
  return <CurvePlot title={wordsOf(of.channel)} label={t("{channel} over time", { channel: wordsOf(of.channel) })} curves={curves} x={{ unit: "s" }} y={{ unit: of.unit }} says={gap} />;
}

// The middle of each bucket, and how far it reaches.
function curveOf({ lowest, highest }: RecordingCurve, { start_s: start, width_s: width }: RecordingCurves, name: string, at: number): Curve {
  const x = lowest.map((_, bucket) => start + (bucket + 0.5) * width);
  const y = lowest.map((low, bucket) => { const high = highest[bucket]; return low == null || high == null ? null : (low + high) / 2; });
  return { name, role: roleOf(at), x, y, reach: { lower: lowest, upper: highest } };
}
