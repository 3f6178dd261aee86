// What is done to all plots of a board at once.

import type { JSX } from "preact";
import { useState } from "preact/hooks";
import { t } from "../i18n/text.ts";
import type { Store } from "../store.ts";
import type { BoardState } from "./board-state.ts";
import { MOST_PLOTS, type PlotKind } from "./layout.ts";
import { panned, zoomed, type Range } from "./range.ts";

const WINDOWS_S = [10, 30, 60, 120];
const KINDS: [PlotKind, string][] = [["time", t("over time")], ["spectrum", t("spectrum")], ["xy", t("one over another")]];

interface Options {
  state: BoardState;
  range: Store<Range>;
  live: boolean;
  following: boolean;
  channels: string[];
  onRange: (range: Range) => void;
  onCursor: () => void;
}

export function Toolbar({ state, range, live, following, channels, onRange, onCursor }: Options): JSX.Element {
  const [copied, setCopied] = useState(false);
  const copy = async () => {
    await navigator.clipboard?.writeText(addressOf(state));
    setCopied(true);
    setTimeout(() => setCopied(false), 1500);
  };
  const add = (kind: PlotKind) => state.setPlots([...state.plots, { kind, channels: channels.slice(0, kind === "xy" ? 2 : 1) }]);
  const window = following && typeof state.shown === "object" && "follow" in state.shown ? state.shown.follow : 30;
  return (
    <div class="toolbar small" role="toolbar" aria-label={t("Plots")}>
      {live ? (
        <>
          <button type="button" aria-pressed={following} onClick={() => state.setShown(following ? { ...range.value } : { follow: window })}>{following ? t("Hold") : t("Follow")}</button>
          <label>{t("Last")} <select value={window} onChange={(event) => state.setShown({ follow: Number(event.currentTarget.value) })}>{WINDOWS_S.map((one) => <option key={one} value={one}>{`${one} s`}</option>)}</select></label>
        </>
      ) : null}
      <button type="button" onClick={() => onRange(zoomed(range.value, 0.5))} aria-label={t("Zoom in")}>+</button>
      <button type="button" onClick={() => onRange(zoomed(range.value, 2))} aria-label={t("Zoom out")}>−</button>
      <button type="button" onClick={() => onRange(panned(range.value, -0.5))} aria-label={t("Earlier")}>◀</button>
      <button type="button" onClick={() => onRange(panned(range.value, 0.5))} aria-label={t("Later")}>▶</button>
      <button type="button" onClick={() => state.setShown("whole")}>{t("Whole run")}</button>
      <button type="button" onClick={onCursor} disabled={state.cursors.length >= 6}>{t("Add a cursor")}</button>
      <label><span class="hidden">{t("Add a plot")}</span>
        <select value="" disabled={state.plots.length >= MOST_PLOTS} onChange={(event) => { add(event.currentTarget.value as PlotKind); event.currentTarget.value = ""; }}>
          <option value="" disabled>{t("Add a plot …")}</option>
          {KINDS.map(([kind, name]) => <option key={kind} value={kind}>{name}</option>)}
        </select>
      </label>
      <button type="button" onClick={() => void copy()}>{copied ? t("Copied") : t("Copy the link")}</button>
      <button type="button" class="plain" onClick={state.reset}>{t("Usual plots")}</button>
      <span class="quiet hint">{t("Drag: zoom. Ctrl and wheel: zoom. Shift and drag: move. Keys: + − 0 c f ← →")}</span>
    </div>
  );
}

// With the plots in it also where they are those of the person who sends it.
function addressOf(state: BoardState): string {
  const url = new URL(location.href);
  const text = state.plots.map(({ kind, channels }) => ({ time: "", spectrum: "psd:", xy: "xy:" })[kind] + channels.join(",")).join(";");
  url.searchParams.set("plots", text);
  return url.href;
}
