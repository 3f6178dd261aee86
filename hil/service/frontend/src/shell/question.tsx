// The window in which the page asks. All around it is out of reach but the emergency stop, which stands above it.

import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import { dismiss, question, type Question } from "../question.ts";
import { useStore } from "../store.ts";

let asked = 0;

export function QuestionWindow(): JSX.Element | null {
  const one = useStore(question), of = useRef<{ one: Question; key: number } | null>(null);
  if (one === null) return null;
  if (of.current?.one !== one) of.current = { one, key: ++asked };
  return <Open key={of.current.key} of={one} />;
}

function Open({ of: { words, yes, no, answer } }: { of: Question }): JSX.Element {
  const curtain = useRef<HTMLDivElement>(null), first = useRef<HTMLButtonElement>(null);
  useLayoutEffect(() => {
    const before = document.activeElement, stop = document.querySelector("button.stop");
    const free = hold([curtain.current, stop].filter((one) => one !== null));
    first.current?.focus();
    const keyed = (event: KeyboardEvent) => {
      if (event.key === "Escape" && !(event.target as Element).closest?.("dialog")) dismiss(); // another window has its own
    };
    addEventListener("keydown", keyed);
    return () => {
      removeEventListener("keydown", keyed);
      free();
      if (before instanceof HTMLElement) before.focus({ preventScroll: true });
    };
  }, []);
  return (
    <div class="curtain" ref={curtain}>
      <div class="question" role="alertdialog" aria-labelledby="question-words">
        <div id="question-words" class="words">{words}</div>
        <div class="row">
          <button type="button" class="main" onClick={() => answer(true)}>{yes}</button>
          <button type="button" ref={first} onClick={() => answer(false)}>{no}</button>
        </div>
      </div>
    </div>
  );
}

// Everything of the page but what is kept takes no click and no key until it is freed.
function hold(kept: Element[]): () => void {
  const held: Element[] = [];
  const within = (element: Element) => {
    for (const one of element.children) {
      if (kept.includes(one) || one.hasAttribute("inert")) continue;
      if (kept.some((other) => one.contains(other))) within(one);
      else held.push(one);
    }
  };
  within(document.body);
  for (const one of held) one.toggleAttribute("inert", true);
  return () => { for (const one of held) one.removeAttribute("inert"); };
}
