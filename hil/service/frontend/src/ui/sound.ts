// Tones for who does not look at the screen: made by the browser, no file. Off until somebody turns them on here.

import type { BenchState } from "../live.ts";
import { Store } from "../store.ts";

export type Sound = "trip" | "prompt" | "end";

const KEY = "sound";
const inBrowser = typeof document !== "undefined";

export const soundOn = new Store(inBrowser && localStorage.getItem(KEY) === "on");

// Hertz and seconds of each tone, one after the other: a trip falls, a prompt rises, an end is one.
const TONES: Record<Sound, readonly (readonly [number, number])[]> = {
  trip: [[880, 0.18], [440, 0.3], [880, 0.18], [440, 0.3]],
  prompt: [[660, 0.15], [990, 0.25]],
  end: [[550, 0.4]],
};
const LOUDNESS = 0.25;
const EDGE_S = 0.015; // a tone that begins at once clicks

const held = ({ running }: BenchState): boolean => running?.doing.startsWith("held") ?? false;
const stopped = ({ bench }: BenchState): boolean => bench.state === "emergency_stop";

// What has just happened on a bench that is worth a tone; the first look at a bench is silent.
export function soundOf(before: BenchState | null, now: BenchState): Sound | null {
  if (before === null) return null;
  if ((stopped(now) && !stopped(before)) || (held(now) && !held(before))) return "trip";
  const asked = now.running?.prompt?.text;
  if (asked && asked !== before.running?.prompt?.text) return "prompt";
  return before.running && before.running.id !== now.running?.id ? "end" : null;
}

let context: AudioContext | null = null;

// Browsers make no sound before somebody has touched the page: a panel that was loaded anew waits for that.
function ready(): AudioContext {
  context ??= new AudioContext();
  void context.resume();
  return context;
}

if (inBrowser) addEventListener("pointerdown", () => { if (soundOn.value) ready(); });

export function turnSound(on: boolean): void {
  localStorage.setItem(KEY, on ? "on" : "off");
  soundOn.value = on;
  if (on) play("end");
}

export function play(sound: Sound): void {
  if (!soundOn.value) return;
  const audio = ready();
  let start = audio.currentTime + 0.02;
  for (const [hertz, seconds] of TONES[sound]) {
    const tone = new OscillatorNode(audio, { frequency: hertz, type: "triangle" }), loudness = new GainNode(audio, { gain: 0 });
    loudness.gain.setValueAtTime(0, start);
    loudness.gain.linearRampToValueAtTime(LOUDNESS, start + EDGE_S);
    loudness.gain.setValueAtTime(LOUDNESS, start + seconds - EDGE_S);
    loudness.gain.linearRampToValueAtTime(0, start + seconds);
    tone.connect(loudness).connect(audio.destination);
    tone.start(start);
    tone.stop(start + seconds);
    start += seconds;
  }
}
