// What the service refused, and what to do: above the view, or at the form that was sent.

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { Refused } from "../api/client.ts";
import { English } from "../i18n/english.tsx";
import { useStore, type Store } from "../store.ts";

export function Refusal({ of }: { of: Store<Error | null> }): JSX.Element | null {
  const error = useStore(of), shown = useRef<HTMLParagraphElement>(null);
  useEffect(() => shown.current?.scrollIntoView({ block: "nearest" }), [error]); // what was refused may stand far below
  if (!error) return null;
  if (!(error instanceof Refused)) return <p class="alarm" role="alert" ref={shown}><English>{error.message}</English></p>;
  // What is wrong and what to do are sentences of their own, each in the reader's language where it is known.
  return <p class="alarm" role="alert" ref={shown}>{error.where ? <><English>{error.where}</English>{": "}</> : null}<English>{error.what}</English>{error.fix ? <>{"\n"}<English>{error.fix}</English></> : null}</p>;
}
