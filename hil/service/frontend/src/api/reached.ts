// Whether the service answers what it is asked, and knows who asks: what is shown may be old otherwise.

import { Store } from "../store.ts";

const LATE_MS = 3000; // a flooded service closes a connection now and then

export const silent = new Store(false);
let answeredMs = Date.now();

export function noteAnswer(): void {
  answeredMs = Date.now();
  silent.value = false;
}

export function noteSilence(): void {
  if (Date.now() - answeredMs > LATE_MS) silent.value = true;
}

// Counts the answers by which the service may no longer know who asks; the session looks whether that is so.
export const unknown = new Store(0);

export function noteUnknown(): void {
  unknown.value += 1;
}
