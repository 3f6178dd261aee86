// Whether the service answers what it is asked: what is shown may be old otherwise.

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
