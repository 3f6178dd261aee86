// Recordings that people gave: all of them, and one with its channels and what can be done with it.

import type { ComponentChildren, JSX } from "preact";
import { useState } from "preact/hooks";
import { API, ask, post } from "../../api/client.ts";
import type { Recording } from "../../api/types.ts";
import { to } from "../../addresses.ts";
import { attempt, isMissing, useData, type Asked } from "../../data.ts";
import { bytes, duration, percent, whole } from "../../format.ts";
import { English } from "../../i18n/english.tsx";
import { t } from "../../i18n/text.ts";
import { agreed } from "../../question.ts";
import { go } from "../../router.ts";
import { useMay } from "../../session.ts";
import { Badge, Facts, Heading, Loaded, Moment, Scroll, Section } from "../../ui/parts.tsx";
import { NoneThere } from "../none-there.tsx";
import { Curves } from "./curves.tsx";
import { ColumnsField, GiveRecording } from "./give-recording.tsx";
import { columnsFrom } from "./send-recording.ts";

const AGAIN_MS = 2000;

export const useRecordings = (): Asked<Recording[]> => useData<Recording[]>("/recordings", AGAIN_MS);
const kindOf = (one: Recording): string => one.name.slice(one.name.lastIndexOf(".") + 1).toUpperCase();

export function Recordings(): JSX.Element {
  const recordings = useRecordings(), may = useMay();
  return (
    <>
      <Heading>{t("Recordings")}</Heading>
      <p class="quiet">{t("Files of this and other tools, to identify models from and to compare with models. What runs here record is found among the runs.")}</p>
      {may("engineer") ? <GiveRecording onGiven={(one) => go(to.recording(one.id))} /> : null}
      <Section title={t("All recordings")} label="all">
        <Loaded of={recordings} what={t("recordings")}>{(all) => all.length ? <List all={all} /> : <p class="quiet">{t("None yet: give one above, as MCAP, MDF, CSV, Parquet, MAT, HDF5 or TDMS.")}</p>}</Loaded>
      </Section>
    </>
  );
}

function List({ all }: { all: Recording[] }): JSX.Element {
  return (
    <Scroll label={t("Recordings")}><table>
      <thead><tr><th scope="col" class="number">{t("number")}</th><th scope="col">{t("file")}</th><th scope="col">{t("state")}</th><th scope="col">{t("kind")}</th><th scope="col" class="number">{t("size")}</th><th scope="col" class="number">{t("duration")}</th><th scope="col" class="number">{t("channels")}</th><th scope="col">{t("given by")}</th><th scope="col">{t("given")}</th></tr></thead>
      <tbody>{all.map((one) => (
        <tr key={one.id}>
          <td class="number"><a href={to.recording(one.id)}>{one.id}</a></td><th scope="row"><a href={to.recording(one.id)}>{one.name}</a></th>
          <td class="shared"><State of={one} /></td><td>{kindOf(one)}</td><td class="number">{bytes(one.size)}</td><td class="number">{one.duration_s == null ? "–" : duration(one.duration_s)}</td>
          <td class="number">{one.channel_count || "–"}</td><td>{one.given_by}</td><td><Moment at={one.given_at} /></td>
        </tr>
      ))}</tbody>
    </table></Scroll>
  );
}

function State({ of: one }: { of: Recording }): JSX.Element {
  return <><Badge kind={one.state} />{one.state === "arriving" ? <span class="reason">{t("{share} is here", { share: percent(one.received / one.size) })}</span> : one.reason ? <span class="reason"><English>{one.reason}</English></span> : null}</>;
}

export function RecordingView({ id }: { id: number }): JSX.Element {
  const one = useData<Recording>(`/recordings/${id}`, AGAIN_MS);
  if (isMissing(one)) return <NoneThere kind="recording" name={id} />;
  return <Loaded whole of={one} what={t("recording {number}", { number: id })}>{(found) => <Found key={found.state} recording={found} onChanged={one.again} />}</Loaded>;
}

function Found({ recording: one, onChanged }: { recording: Recording; onChanged: () => void }): JSX.Element {
  const may = useMay(), isReady = one.state === "ready", channels = one.channels ?? [], others = (useRecordings().data ?? []).filter((other) => other.id !== one.id && other.state === "ready"), notes = one.notes ?? [];
  const remove = async () => {
    if (!(await agreed(t("Remove the recording {name}? Studies of it stay.", { name: one.name }), t("Remove"), t("Cancel")))) return;
    if (await attempt(async () => { await ask("DELETE", `/recordings/${one.id}`); return true; })) go(to.list("recordings"));
  };
  return (
    <>
      <Heading kind={<a href={to.list("recordings")}>{t("Recordings")}</a>}>{one.name} <Badge kind={one.state} /></Heading>
      <RecordingFacts of={one} />
      {one.state === "refused" ? <p class="bad" role="alert"><English>{one.reason}</English></p> : null}
      {one.state === "checking" ? <p class="quiet" role="status">{t("It is being read …")}</p> : null}
      {one.state === "arriving" ? <p class="quiet">{t("{share} is here. Give the same file again to go on; what has not arrived after a day is removed.", { share: percent(one.received / one.size) })}</p> : null}
      <div class="row level">
        {isReady && may("engineer") ? <a href={`${to.list("identifications")}?recordings=${one.id}`}>{t("Identify a model")}</a> : null}
        {isReady && may("engineer") ? <a href={`${to.list("diagnoses")}?recordings=${one.id}`}>{t("Diagnose")}</a> : null}
        {(one.files ?? []).map((name) => <a key={name} href={`${API}/recordings/${one.id}/files/${encodeURIComponent(name)}`} download>{name}</a>)}
        {may("engineer") && !one.place && one.state !== "checking" ? <button type="button" onClick={() => void remove()}>{t("Remove the recording")}</button> : null}
      </div>
      {notes.length ? <Section title={t("What reading it assumed")} label="notes"><ul>{notes.map((note) => <li key={note}><English>{note}</English></li>)}</ul></Section> : null}
      {isReady ? <Section title={t("Curves")} label="curves"><Curves recording={one} others={others} /></Section> : null}
      {channels.length ? <Section title={t("Channels")} label="channels"><Channels of={channels} /></Section> : null}
      {may("engineer") && !one.place && (isReady || one.state === "refused") ? <Section title={t("Which column is which channel")} label="columns"><ReadAnew recording={one} onChanged={onChanged} /></Section> : null}
    </>
  );
}

function RecordingFacts({ of: one }: { of: Recording }): JSX.Element {
  const facts: ([string, ComponentChildren] | null)[] = [
    [t("kind"), kindOf(one)], [t("size"), bytes(one.size)],
    one.duration_s == null ? null : [t("duration"), duration(one.duration_s)],
    one.samples == null ? null : [t("samples"), whole(one.samples)],
    one.plan ? [t("run of the plan"), one.plan] : null,
    [t("given by"), one.given_by], [t("given"), <Moment at={one.given_at} />],
    one.sha256 ? ["SHA-256", <code>{one.sha256}</code>] : null, one.place ? [t("on service"), one.place] : null,
  ];
  return <Facts>{facts.filter((fact) => fact !== null)}</Facts>;
}

function Channels({ of: channels }: { of: NonNullable<Recording["channels"]> }): JSX.Element {
  return (
    <Scroll label={t("Channels")}><table>
      <thead><tr><th scope="col">{t("channel")}</th><th scope="col">{t("unit")}</th></tr></thead>
      <tbody>{channels.map((one) => <tr key={one.name}><th scope="row">{one.name}</th><td>{one.unit}</td></tr>)}</tbody>
    </table></Scroll>
  );
}

function ReadAnew({ recording: one, onChanged }: { recording: Recording; onChanged: () => void }): JSX.Element {
  const [text, setText] = useState(one.columns.join("\n"));
  const read = async (event: Event) => {
    event.preventDefault();
    if (await attempt(() => post<Recording>(`/recordings/${one.id}/check`, { columns: columnsFrom(text) }))) onChanged();
  };
  return <form onSubmit={(event) => void read(event)}><ColumnsField value={text} onChange={setText} /><button type="submit">{t("Read it anew")}</button></form>;
}
