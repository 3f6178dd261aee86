// What a person is asked before something is done. The page asks by itself: while a browser's own window is open,
// nothing of the page works, the emergency stop least of all.

import type { ComponentChildren } from "preact";
import { Store } from "./store.ts";

export interface Question {
  words: ComponentChildren;
  yes: string; // the button that agrees, named by what is done then
  no: string;
  answer: (agreed: boolean) => void;
}

export const question = new Store<Question | null>(null);

// Whether somebody agrees. One question at a time: a later one, a stop or another view answers with no.
export function agreed(words: ComponentChildren, yes: string, no: string): Promise<boolean> {
  dismiss();
  return new Promise((resolve) => {
    const mine: Question = { words, yes, no, answer: (is) => {
      if (question.value === mine) question.value = null;
      resolve(is);
    } };
    question.value = mine;
  });
}

export const dismiss = (): void => question.value?.answer(false);
