// One plot with its key: channels are dropped on it, chosen from a list, and taken off again.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import type { Mark, RunView } from "../api/types.ts";
import { reading, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import { useStore, type Store } from "../store.ts";
import { roleOf } from "./frame.ts";
import type { PlotSpec } from "./layout.ts";
import { marksOf, type ChannelLimit } from "./limit-lines.ts";
import type { Range } from "./range.ts";
import type { Source } from "./source.ts";
import { SpectrumPlot } from "./spectrum-plot.tsx";
import { TimePlot } from "./time-plot.tsx";
import { valueAt } from "./traces.ts";
import { useSettled } from "./settled.ts";
import { XyPlot } from "./xy-plot.tsx";

export const DRAGGED = "application/x-channel";

interface Options {
  plot: PlotSpec;
  number: number;
  view: RunView;
  marks: Mark[];
  limits: ChannelLimit[];
  source: Source;
  following: boolean;
  hover: Store<number | null>;
  cursors: number[];
  chosen: number;
  onRange: (range: Range) => void;
  onCursor: (cursor: number, at: number) => void;
  onHover: (at: number | null) => void;
  onDrop: (channel: string) => void;
  onTake: (channel: string) => void;
  onRemove: () => void;
}

const KINDS = { time: "", spectrum: t("Spectrum"), xy: "XY" };

export function PlotCard(options: Options): JSX.Element {
  const { plot, number, view, source, hover } = options;
  const [over, setOver] = useState(false);
  const settled = useSettled(source.range, options.following, source.last);
  const others = Object.keys(view.channels).filter((channel) => !plot.channels.includes(channel));
  const what = [KINDS[plot.kind], plot.channels.map(wordsOf).join(", ") || t("no channel")].filter(Boolean).join(": ");
  const label = t("Plot {number}: {what}", { number, what });
  const failed = plot.kind === "time" ? plot.channels.flatMap((channel) => marksOf(options.limits.filter((one) => one.failed), [channel], view.channels[channel] ?? "")).map((one) => one.label) : [];
  const drop = (event: DragEvent) => {
    const channel = event.dataTransfer?.getData(DRAGGED);
    setOver(false);
    if (!channel) return;
    event.preventDefault();
    options.onDrop(channel);
  };
  return (
    <figure class={over ? "plot over" : "plot"} aria-label={label}
      onDragOver={(event) => { if (event.dataTransfer?.types.includes(DRAGGED)) { event.preventDefault(); setOver(true); } }} onDragLeave={() => setOver(false)} onDrop={drop}>
      <figcaption class="small">
        {plot.kind === "time" ? null : <b>{`${KINDS[plot.kind]}: `}</b>}
        {plot.channels.map((channel, at) => <Chip key={channel} channel={channel} role={plot.kind === "time" ? roleOf(at) : ""} unit={view.channels[channel] ?? ""} source={source} hover={hover} onTake={() => options.onTake(channel)} />)}
        <span class="plot-buttons">
          <select aria-label={t("Add a channel to plot {number}", { number })} value="" onChange={(event) => { options.onDrop(event.currentTarget.value); event.currentTarget.value = ""; }}>
            <option value="" disabled>{t("Channel …")}</option>
            {others.map((channel) => <option key={channel} value={channel}>{channel}</option>)}
          </select>
          <button type="button" class="plain" aria-label={t("Remove plot {number}", { number })} title={t("Remove this plot")} onClick={options.onRemove}>✕</button>
        </span>
      </figcaption>
      <div class="plot-place" tabIndex={0} role="img" aria-label={[label, ...failed].join("; ")}>
        {plot.kind === "time" ? <TimePlot channels={plot.channels} units={view.channels} traces={source.traces} range={source.range} marks={options.marks} limits={options.limits} cursors={options.cursors} chosen={options.chosen} onRange={options.onRange} onCursor={options.onCursor} onHover={options.onHover} /> : null}
        {plot.kind === "spectrum" && plot.channels[0] && settled ? <SpectrumPlot run={view.run} channel={plot.channels[0]} unit={view.channels[plot.channels[0]] ?? ""} range={settled} /> : null}
        {plot.kind === "xy" && settled ? <XyPlot run={view.run} channels={plot.channels} units={view.channels} range={settled} /> : null}
        {plot.kind !== "time" && !settled ? <p class="quiet canvas">{t("Too little has been measured yet.")}</p> : null}
      </div>
    </figure>
  );
}

function Chip({ channel, role, unit, source, hover, onTake }: { channel: string; role: string; unit: string; source: Source; hover: Store<number | null>; onTake: () => void }): JSX.Element {
  const at = useStore(hover);
  const traces = useStore(at === null ? source.newest : source.traces);
  const value = valueAt(traces, channel, at ?? traces.time.at(-1) ?? 0);
  const text = !value ? "" : value.lowest === value.highest || at === null ? reading(value.highest, unit) : `${reading(value.lowest, unit, "")} … ${reading(value.highest, unit)}`;
  return (
    <span class="chip">
      {role ? <span class={`swatch ${role}`} /> : null}
      <span title={channel}>{wordsOf(channel)}</span> <output>{text}</output>
      <button type="button" class="plain" aria-label={t("Take {channel} off", { channel: wordsOf(channel) })} onClick={onTake}>×</button>
    </span>
  );
}
