// Plots of a run, under way or over, with its channels beside them: any channel onto any plot, by hand or by list.

import type { JSX } from "preact";
import { useMemo, useRef, useState } from "preact/hooks";
import type { Mark, RunView } from "../api/types.ts";
import { t } from "../i18n/text.ts";
import { useLive, type Live } from "../live.ts";
import { Store, useStore } from "../store.ts";
import { useBoardState } from "./board-state.ts";
import { ChannelList } from "./channel-list.tsx";
import { CursorTable } from "./cursor-table.tsx";
import { channelsOf, withChannel, withoutChannel } from "./layout.ts";
import type { ChannelLimit } from "./limit-lines.ts";
import { PlotCard } from "./plot-card.tsx";
import { isFollowing, panned, zoomed, type Range } from "./range.ts";
import { useSource } from "./source.ts";
import { Toolbar } from "./toolbar.tsx";

export interface BoardOptions {
  view: RunView;
  plan: string;
  limits: ChannelLimit[];
  bench: string | null; // of a run that goes on: its samples are taken from there
}

export function Board({ view, plan, limits, bench }: BoardOptions): JSX.Element {
  const names = useMemo(() => Object.keys(view.channels), [view]);
  const failed = [...new Set(limits.filter((one) => one.failed).map((one) => one.channel))];
  const state = useBoardState(plan, names, failed, bench !== null);
  const channels = channelsOf(state.plots);
  const live = useLive(bench, channels);
  const marks = useMarks(live, view);
  const source = useSource({ run: view.run, live: bench === null ? null : live, channels, shown: state.shown, first: view.first_s, last: view.last_s });
  const [hover] = useState(() => new Store<number | null>(null)); // the pointer moves in every frame
  const board = useRef<HTMLDivElement>(null);
  const setRange = ({ from, to }: Range) => {
    if (bench === null) source.range.value = { from, to }; // plots move at once, everything else when they rest
    state.setShown({ from, to });
  };
  const follow = bench !== null && isFollowing(state.shown);
  const addCursor = () => state.setCursors([...state.cursors, hover.value ?? placeOf(source.range.value, state.cursors.length)].slice(0, 6), state.cursors.length);
  const moveCursor = (which: number, at: number) => state.setCursors(state.cursors.map((one, number) => (number === which ? at : one)), which);
  const keyed = (event: KeyboardEvent) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement || event.ctrlKey || event.metaKey || event.altKey) return;
    const range = source.range.value;
    const step = (event.shiftKey ? 0.1 : 0.01) * (range.to - range.from), sign = event.key === "ArrowLeft" ? -1 : 1, cursor = state.cursors[state.chosen];
    const does: Record<string, () => void> = {
      "+": () => setRange(zoomed(range, 0.5)), "-": () => setRange(zoomed(range, 2)), "0": () => state.setShown("whole"),
      f: () => { if (bench !== null) state.setShown({ follow: 30 }); }, c: addCursor,
      Delete: () => state.setCursors(state.cursors.filter((_, at) => at !== state.chosen)),
      ArrowLeft: () => (cursor === undefined ? setRange(panned(range, -0.2)) : moveCursor(state.chosen, cursor + sign * step)),
      ArrowRight: () => (cursor === undefined ? setRange(panned(range, 0.2)) : moveCursor(state.chosen, cursor + sign * step)),
    };
    const work = does[event.key];
    if (!work) return;
    event.preventDefault();
    work();
  };
  const change = (at: number, changed: (typeof state.plots)[number] | null) => state.setPlots(state.plots.flatMap((plot, number) => (number === at ? (changed ? [changed] : []) : [plot])));
  return (
    <div class="board" ref={board} onKeyDown={keyed}>
      <Toolbar state={state} range={source.range} live={bench !== null} following={follow} onRange={setRange} onCursor={addCursor} channels={names} />
      <CursorTable traces={source.traces} channels={channels} units={view.channels} cursors={state.cursors} chosen={state.chosen} onChoose={(which) => state.setCursors(state.cursors, which)} onRemove={(which) => state.setCursors(state.cursors.filter((_, at) => at !== which), 0)} />
      <div class="board-columns">
        <div class="plots">
          {state.plots.map((plot, at) => (
            <PlotCard
              key={`${at} ${plot.kind}`} plot={plot} number={at + 1} view={view} marks={marks} limits={limits} source={source} following={follow} hover={hover}
              cursors={state.cursors} chosen={state.chosen} onRange={setRange} onCursor={moveCursor} onHover={(at) => { hover.value = at; }}
              onDrop={(channel) => change(at, withChannel(plot, channel))} onTake={(channel) => change(at, withoutChannel(plot, channel))} onRemove={() => change(at, null)}
            />
          ))}
          {state.plots.length ? null : <p class="quiet">{t("No plot. Add one above.")}</p>}
        </div>
        <div class="board-side">
          <ChannelList channels={view.channels} plots={state.plots} newest={bench === null ? null : source.newest} onPut={(channel, at) => change(at, withChannel(state.plots[at] ?? { kind: "time", channels: [] }, channel))} />
        </div>
      </div>
    </div>
  );
}

// Where a cursor comes that no pointer places: each beside the last.
const placeOf = ({ from, to }: Range, number: number): number => from + (0.4 + 0.1 * (number % 6)) * (to - from);

function useMarks(live: Live, view: RunView): Mark[] {
  const found = useStore(live.marks);
  return useMemo(() => (found && found.run === view.run ? found.marks.map((mark) => ({ step_s: null, ...mark })) : view.marks), [found, view]);
}
