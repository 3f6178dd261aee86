// Given recordings laid over runs: chosen beside them, each with the moment of its step.

import type { JSX } from "preact";
import type { Recording } from "../api/types.ts";
import { to } from "../addresses.ts";
import { useData } from "../data.ts";
import { t } from "../i18n/text.ts";
import { roleOf } from "../plot/frame.ts";
import { NumberInput } from "../ui/number-field.tsx";
import { recordingsText, type Beside } from "./compare-beside.ts";

const MOST = 3;

interface Options {
  chosen: Beside[];
  runs: number; // their colours come first
  onChange: (text: string) => void;
}

export function ChooseRecordings({ chosen, runs, onChange }: Options): JSX.Element | null {
  const all = useData<Recording[]>("/recordings").data ?? [];
  const offered = all.filter((one) => one.state === "ready" && !chosen.some(({ id }) => id === one.id));
  if (!offered.length && !chosen.length) return null;
  const nameOf = (id: number): string => all.find((one) => one.id === id)?.name ?? "";
  return (
    <div class="row small">
      {chosen.map(({ id, step }, at) => (
        <span key={id} class="chip"><span class={`swatch ${roleOf(runs + at)}`} /><a href={to.recording(id)} title={nameOf(id)}>{t("recording {number}", { number: id })}</a>{" "}
          <label>{t("step at, s")} <NumberInput rested required size={8} value={String(step)} onText={(text) => { if (text) onChange(recordingsText(chosen.map((one) => (one.id === id ? { id, step: Number(text) } : one)))); }} /></label>
          <button type="button" class="plain" aria-label={t("Leave out recording {number}", { number: id })} onClick={() => onChange(recordingsText(chosen.filter((one) => one.id !== id)))}>×</button>
        </span>
      ))}
      {chosen.length < MOST && offered.length ? (
        <label>{t("Given recording")}{" "}
          <select value="" onChange={(event) => onChange(recordingsText([...chosen, { id: Number(event.currentTarget.value), step: 0 }]))}>
            <option value="" disabled>{t("choose …")}</option>
            {offered.map((one) => <option key={one.id} value={one.id}>{`${one.id}: ${one.name}`}</option>)}
          </select>
        </label>
      ) : null}
    </div>
  );
}
