// Values at the cursors, and differences from the first.

import type { JSX } from "preact";
import { figure, fixed, joined, wordsOf } from "../format.ts";
import { t } from "../i18n/text.ts";
import { useStore, type Store } from "../store.ts";
import { Scroll } from "../ui/parts.tsx";
import { NAMES_OF_CURSORS } from "./canvas.ts";
import { middleOf, valueAt, type Traces } from "./traces.ts";

interface Options {
  traces: Store<Traces>;
  channels: string[];
  units: Record<string, string>;
  cursors: number[];
  chosen: number;
  onChoose: (cursor: number) => void;
  onRemove: (cursor: number) => void;
}

export function CursorTable({ traces: store, channels, units, cursors, chosen, onChoose, onRemove }: Options): JSX.Element | null {
  const traces = useStore(store);
  if (!cursors.length) return null;
  const letter = (at: number): string => NAMES_OF_CURSORS[at] ?? "";
  const first = cursors[0] ?? 0;
  return (
    <section class="cursors" aria-labelledby="cursors-heading">
      <h3 id="cursors-heading">{t("Cursors")}</h3>
      <Scroll label={t("Values at the cursors")}>
        <table>
          <thead>
            <tr><th scope="col">{t("channel")}</th>
              {cursors.map((_, at) => (
                <th scope="col" class="number" key={at}>
                  <button type="button" class="plain" aria-pressed={at === chosen} aria-label={t("Cursor {letter}", { letter: letter(at) })} onClick={() => onChoose(at)}>{letter(at)}</button>
                  <button type="button" class="plain" aria-label={t("Remove cursor {letter}", { letter: letter(at) })} onClick={() => onRemove(at)}>×</button>
                </th>
              ))}
              {cursors.slice(1).map((_, at) => <th scope="col" class="number" key={at}>{`${letter(at + 1)} − A`}</th>)}
            </tr>
          </thead>
          <tbody>
            <tr><th scope="row">{t("time")}</th>
              {cursors.map((one, at) => <td class="number" key={at}>{joined(fixed(one, 3), "s")}</td>)}
              {cursors.slice(1).map((one, at) => <td class="number" key={at}>{joined(fixed(one - first, 3).replace("-", "−"), "s")}</td>)}
            </tr>
            {channels.map((channel) => {
              const values = cursors.map((one) => valueAt(traces, channel, one));
              const middle = middleOf(values[0] ?? null);
              return (
                <tr key={channel}><th scope="row" title={channel}>{wordsOf(channel)}</th>
                  {values.map((value, at) => <td class="number" key={at}>{!value ? "–" : value.lowest === value.highest ? figure(value.lowest, units[channel]) : `${figure(value.lowest)} … ${figure(value.highest, units[channel])}`}</td>)}
                  {values.slice(1).map((value, at) => {
                    const other = middleOf(value);
                    return <td class="number" key={at}>{middle === null || other === null ? "–" : figure(other - middle, units[channel])}</td>;
                  })}
                </tr>
              );
            })}
          </tbody>
        </table>
      </Scroll>
      <p class="quiet">{t("Where a place on the screen has several samples, lowest and highest are given, and differences are between their middles.")}</p>
    </section>
  );
}
