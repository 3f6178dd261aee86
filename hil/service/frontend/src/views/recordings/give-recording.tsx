// A recording is given: a file, and which of its columns are which channels.

import type { JSX } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Recording } from "../../api/types.ts";
import { attempt } from "../../data.ts";
import { percent } from "../../format.ts";
import { t } from "../../i18n/text.ts";
import { useMe } from "../../session.ts";
import { columnsFrom, emptyFile, sendRecording } from "./send-recording.ts";

const ENDINGS = ".mcap,.mf4,.csv,.txt,.tsv,.lvm,.ascii,.parquet,.mat,.h5,.hdf5,.hdf,.tdms";

export function GiveRecording({ onGiven }: { onGiven: (recording: Recording) => void }): JSX.Element {
  const [file, setFile] = useState<File | null>(null), [columns, setColumns] = useState("");
  const [share, setShare] = useState<number | null>(null);
  const control = useRef<AbortController | null>(null), me = useMe();
  useEffect(() => () => control.current?.abort(), []);
  const give = async (event: Event) => {
    event.preventDefault();
    if (!file) return;
    const { signal } = control.current = new AbortController();
    setShare(0);
    const given = await attempt(async () => {
      try {
        return await sendRecording({ file, columns: columnsFrom(columns), me: me.name, signal, onShare: setShare });
      } catch (error) {
        if (signal.aborted) return null;
        throw error;
      }
    });
    if (signal.aborted) return;
    setShare(null);
    if (given) onGiven(given);
  };
  const choose = (field: HTMLInputElement) => {
    const chosen = field.files?.[0] ?? null, isEmpty = chosen !== null && chosen.size === 0;
    if (isEmpty) field.value = ""; // as if it had never been chosen
    setFile(isEmpty ? null : chosen);
    void attempt(() => { if (isEmpty) throw emptyFile(chosen.name); });
  };
  const pause = () => { control.current?.abort(); setShare(null); };
  return (
    <form class="card" onSubmit={(event) => void give(event)}>
      <label class="field">{t("File of a recording")}<input type="file" required disabled={share !== null} accept={ENDINGS} onChange={(event) => choose(event.currentTarget)} /></label>
      <ColumnsField value={columns} onChange={setColumns} />
      <div class="row level">
        <button type="submit" class="main" disabled={!file || share !== null}>{t("Give the recording")}</button>
        {share !== null ? <button type="button" onClick={pause}>{t("Pause")}</button> : null}
      </div>
      {share !== null ? <><progress value={share} aria-label={t("Sent of the recording")} /><p class="quiet" role="status">{t("{share} sent. The page has to stay open; the same file given again later goes on from there.", { share: percent(share) })}</p></> : null}
    </form>
  );
}

// One a line, as on the command line.
export function ColumnsField({ value, onChange }: { value: string; onChange: (text: string) => void }): JSX.Element {
  return (
    <label class="field">{t("Columns of another tool's file, one a line; empty if its columns are named as channels")}
      <textarea rows={3} spellcheck={false} autocomplete="off" placeholder={"time_s=t, unit=ms\nmotor_torque_ref_nm=T_req\nmotor_speed_rad_s=n_EM, unit=rpm, sign=-1"} value={value} onInput={(event) => onChange(event.currentTarget.value)} />
    </label>
  );
}
