// The palette (Ctrl-K): finds any bench, plan, run, model, controller or command by its words.

import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import { get } from "../api/client.ts";
import type { Bench, FoundRuns, Plan, Run } from "../api/types.ts";
import { to } from "../addresses.ts";
import { t } from "../i18n/text.ts";
import { go } from "../router.ts";
import { session } from "../session.ts";
import { Store, useStore } from "../store.ts";
import { kindInWords } from "../ui/kinds.ts";
import { runInWords } from "../ui/run-kind.ts";
import { nameOf } from "../views/runs/run-name.ts";
import { found, type Entry } from "./matching.ts";
import { commands } from "./commands.ts";
import { benchInSight, focusStop, pressStopAt } from "./stop.tsx";

export const paletteOpen = new Store(false);
const MOST = 12;

addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "k") {
    event.preventDefault();
    paletteOpen.value = !paletteOpen.value && session.value.state === "in";
  } else if (event.key === "Escape") paletteOpen.value = false;
});

export function Palette(): JSX.Element | null {
  return useStore(paletteOpen) ? <Open /> : null;
}

function Open(): JSX.Element {
  const dialog = useRef<HTMLDialogElement>(null);
  const [text, setText] = useState("");
  const [at, setAt] = useState(0);
  const entries = useEntries();
  const runs = useRuns(text);
  const shown = useMemo(() => found([...entries, ...runs], text, MOST), [entries, runs, text]);
  useLayoutEffect(() => { dialog.current?.showModal(); }, []); // before the next key comes
  useEffect(() => { document.getElementById(`entry-${at}`)?.scrollIntoView({ block: "nearest" }); }, [at]);
  const close = () => { paletteOpen.value = false; };
  const choose = (entry: Entry | undefined) => {
    if (!entry) return;
    close();
    if (entry.path) go(entry.path); else entry.act?.();
  };
  const keyed = (event: KeyboardEvent) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) setAt((one) => (one + step + shown.length) % Math.max(1, shown.length));
    else if (event.key === "Enter") choose(shown[at]);
    else if (event.key === "Tab") focusStop(close); // it is out of reach behind this window, and never may be
    else return;
    event.preventDefault();
  };
  return (
    <dialog ref={dialog} class="palette" aria-label={t("Find")} onClose={close} onClick={(event) => { if (event.target === dialog.current) { close(); pressStopAt(event.clientX, event.clientY); } }}>
      <input
        type="text" role="combobox" aria-expanded="true" aria-controls="palette-list" aria-autocomplete="list" aria-activedescendant={`entry-${at}`}
        aria-label={t("Find a plan, run, bench, model or command")} placeholder={t("Plan, run, bench, model or command")} autocomplete="off" spellcheck={false}
        value={text} onInput={(event) => { setText(event.currentTarget.value); setAt(0); }} onKeyDown={keyed}
      />
      <ul id="palette-list" role="listbox" aria-label={t("Found")}>
        {shown.map((entry, index) => (
          <li key={`${entry.kind} ${entry.name}`} id={`entry-${index}`} role="option" aria-selected={index === at} onMouseMove={() => setAt(index)} onClick={() => choose(entry)}>
            <span>{entry.name}</span> <span class="quiet">{entry.about}</span><span class="kind">{entry.kind}</span>
          </li>
        ))}
      </ul>
      {shown.length ? null : <p class="quiet" role="status">{t("Nothing has these words.")}</p>}
    </dialog>
  );
}

let known: Entry[] = []; // as the palette had them last: there at once when it is opened again

function useEntries(): Entry[] {
  const [own] = useState(() => commands(benchInSight.value)); // of the bench that was in sight when it was opened
  const [entries, setEntries] = useState<Entry[]>(() => [...own, ...known]);
  useEffect(() => {
    let open = true;
    const asked = [benches(), plans(), named("/models", t("model"), "model", to.model), named("/controllers", t("controller"), "controller", to.controller)];
    void Promise.all(asked.map((one) => one.catch(() => []))).then((all) => {
      known = all.flat();
      if (open) setEntries([...own, ...known]);
    });
    return () => { open = false; };
  }, []);
  return entries;
}

const benches = async (): Promise<Entry[]> => (await get<Bench[]>("/benches")).map((bench) => ({ kind: t("bench"), also: "bench", name: bench.name, about: bench.title, path: to.bench(bench.name) }));
const plans = async (): Promise<Entry[]> => (await get<Plan[]>("/plans")).map((plan) => ({ kind: t("plan"), also: "plan", name: plan.name, about: plan.title, path: to.plan(plan.name) }));
const named = async (path: string, kind: string, also: string, address: (name: string) => string): Promise<Entry[]> => (await get<{ name: string }[]>(path)).map(({ name }) => ({ kind, also, name, about: "", path: address(name) }));

const TYPING_MS = 150;
const VERDICTS = ["pass", "fail", "error", "done"] as const;

// A verdict that was typed, in the reader's language or in English.
const verdictIn = (words: string): string => VERDICTS.find((one) => words.toLowerCase().split(/\s+/).some((word) => word === one || word === kindInWords(one).toLowerCase())) ?? "";

// The service looks for a text as a whole: the others of its words are looked for in what it finds by this one.
const longestOf = (words: string): string => words.split(/\s+/).reduce((longest, one) => (one.length > longest.length ? one : longest), "");

const isNumberOfRun = (number: number): boolean => number > 0 && number < 2 ** 31 - 1;

// The run of a number, and runs that have the words; without any the newest are offered.
function useRuns(text: string): Entry[] {
  const [runs, setRuns] = useState<Entry[]>([]);
  const words = text.trim(), number = Number(/[0-9]+/.exec(words)?.[0] ?? 0);
  useEffect(() => {
    const control = new AbortController();
    const find = async () => {
      // of the list and not by its address: a number of no run is no mistake
      const listed = (filters: Record<string, string>) => get<FoundRuns>(`/run-list?${new URLSearchParams({ ...filters, most: "20" })}`, control.signal).then(({ runs: all }) => all.map(({ run, tags = [] }): Tagged => ({ run, tags })));
      const numbered = isNumberOfRun(number) ? get<Run[]>(`/runs?${new URLSearchParams({ before: String(number + 1), most: "1" })}`, control.signal).then((all) => all.filter((run) => run.id === number).map(untagged)) : null;
      const worded = [...new Set(words ? [words, longestOf(words)] : [])].map((text) => listed({ text }));
      const verdict = verdictIn(words), judged = verdict ? listed({ verdict }) : null;
      const asked = [numbered, ...worded, judged, get<Run[]>("/runs?most=5", control.signal).then((all) => all.map(untagged))].map((one) => one?.catch(() => []) ?? []);
      const all = (await Promise.all(asked)).flat().sort((one, other) => one.tags.length - other.tags.length); // the same run may come without its tags
      if (!control.signal.aborted) setRuns([...new Map(all.map((one) => [one.run.id, one])).values()].map(entryOf));
    };
    const timer = setTimeout(() => void find(), words ? TYPING_MS : 0);
    return () => { control.abort(); clearTimeout(timer); };
  }, [words]);
  return runs;
}

interface Tagged {
  run: Run;
  tags: string[];
}

const untagged = (run: Run): Tagged => ({ run, tags: [] });

// Also by its number alone, by who asked for it, by what was tested and by its tags.
const entryOf = ({ run, tags }: Tagged): Entry => ({
  kind: t("run"), name: t("Run {run}", { run: run.id }), path: to.run(run.id), also: `Run ${run.id} #${run.id} ${run.plan} ${run.requested_by} ${run.dut} ${tags.join(" ")}`,
  about: [nameOf(run), run.bench, runInWords(run)].filter(Boolean).join(", "),
});
