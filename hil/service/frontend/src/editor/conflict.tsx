// Somebody else has saved what one is about to save: whose text is there, the difference, and the choice.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { get, getTagged, Refused } from "../api/client.ts";
import type { Version } from "../api/types.ts";
import { t, tx } from "../i18n/text.ts";
import { Moment, Section } from "../ui/parts.tsx";
import { Difference, type VersionedKind } from "./versions.tsx";

export interface Theirs {
  name: string;
  text: string;
  tag: string;
  by: string; // '' if it was removed
  at: string;
}

// What is there under the name, without a giver if it was removed; null if it is built in.
export async function theirsOf(kind: VersionedKind, name: string, textPath: string): Promise<Theirs | null> {
  try {
    const { text, tag } = await getTagged(textPath);
    const newest = (await get<Version[]>(`/versions/${kind}/${encodeURIComponent(name)}`)).find((one) => one.name === name);
    return newest ? { name, text, tag, by: newest.given_by || t("somebody"), at: newest.given_at } : null;
  } catch (error) {
    if (error instanceof Refused && error.status === 404) return { name, text: "", tag: "", by: "", at: "" };
    throw error;
  }
}

// Saves; null once that is done, else what stands in the way.
export async function saved(save: () => Promise<unknown>, theirs: () => Promise<Theirs | null>): Promise<Theirs | null> {
  try {
    await save();
    return null;
  } catch (error) {
    const there = error instanceof Refused && error.status === 409 ? await theirs() : null;
    if (there) return there;
    throw error;
  }
}

interface Options {
  theirs: Theirs;
  mine: string;
  keep: { name: string; do: () => void };
  take: () => void;
}

export function Conflict({ theirs, mine, keep, take }: Options): JSX.Element {
  const isGone = theirs.by === "", notice = useRef<HTMLDivElement>(null);
  useEffect(() => { // the button that was pressed may stand far below
    notice.current?.closest("section")?.scrollIntoView();
    notice.current?.focus({ preventScroll: true });
  }, [theirs]);
  const said = isGone ? t("{name} was removed after you began to write.", { name: theirs.name }) : tx("{who} saved {name} {moment}, and your text does not have that in it. Nothing of yours is saved yet.", { who: theirs.by, name: theirs.name, moment: <Moment at={theirs.at} /> });
  return (
    <Section title={isGone ? t("It was removed meanwhile") : t("Another text was saved meanwhile")} label="conflict">
      <div class="notice" role="alert" tabIndex={-1} ref={notice}>
        <p>{said}</p>
        <div class="row level"><button type="button" onClick={keep.do}>{keep.name}</button>{isGone ? null : <button type="button" onClick={take}>{t("Discard mine and take theirs")}</button>}</div>
      </div>
      {isGone || theirs.text === mine ? null : <Difference before={theirs.text} after={mine} label={t("Differences, from their text to yours")} />}
    </Section>
  );
}
