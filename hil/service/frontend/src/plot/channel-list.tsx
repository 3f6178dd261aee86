// All channels of a run, to be dragged onto plots or put there by a list.

import type { JSX } from "preact";
import { useMemo, useState } from "preact/hooks";
import { reading, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import { Store, useStore } from "../store.ts";
import type { PlotSpec } from "./layout.ts";
import { DRAGGED } from "./plot-card.tsx";
import { NO_TRACES, valueAt, type Traces } from "./traces.ts";

const NOTHING = new Store<Traces>(NO_TRACES);

interface Options {
  channels: Record<string, string>;
  plots: PlotSpec[];
  newest: Store<Traces> | null;
  onPut: (channel: string, plot: number) => void;
}

export function ChannelList({ channels, plots, newest, onPut }: Options): JSX.Element {
  const [words, setWords] = useState("");
  const traces = useStore(newest ?? NOTHING);
  const shown = useMemo(() => Object.keys(channels).filter((one) => `${one} ${wordsOf(one)}`.includes(words.trim().toLowerCase())), [channels, words]);
  return (
    <section class="channels" aria-labelledby="channels-heading">
      <h3 id="channels-heading">{t("Channels")}</h3>
      <input type="search" aria-label={t("Find a channel")} placeholder={t("Find a channel")} value={words} onInput={(event) => setWords(event.currentTarget.value)} />
      <ul>
        {shown.map((channel) => (
          <li key={channel} draggable onDragStart={(event) => { event.dataTransfer?.setData(DRAGGED, channel); }}>
            <span title={channel}>{wordsOf(channel)} <span class="quiet">{valueText(traces, channel, channels[channel] ?? "")}</span></span>
            <select aria-label={t("Put {channel} onto a plot", { channel: wordsOf(channel) })} value="" onChange={(event) => { onPut(channel, Number(event.currentTarget.value)); event.currentTarget.value = ""; }}>
              <option value="" disabled>{t("onto …")}</option>
              {plots.map((plot, at) => <option key={at} value={at} disabled={plot.channels.includes(channel)}>{t("plot {number}", { number: at + 1 })}</option>)}
            </select>
          </li>
        ))}
      </ul>
    </section>
  );
}

function valueText(traces: Traces, channel: string, unit: string): string {
  const value = valueAt(traces, channel, traces.time.at(-1) ?? 0);
  return value ? reading(value.highest, unit) : unit.replaceAll(" ", "\u00a0");
}
