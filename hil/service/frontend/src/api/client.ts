// Requests to the service, and errors in its words.

import { t } from "../i18n/text.ts";
import { noteDate } from "./clock.ts";
import { noteAnswer, noteSilence, noteUnknown } from "./reached.ts";
import type { Health, Problem } from "./types.ts";

export const API = "/api/v1";
export const WHO = "/me"; // says whether it still knows who asks

export class Refused extends Error {
  readonly status: number;
  readonly what: string;
  readonly where: string;
  readonly fix: string;

  constructor(status: number, problem: Problem) {
    super(problem.where ? `${problem.where}: ${problem.what}` : problem.what);
    this.status = status;
    this.what = problem.what;
    this.where = problem.where ?? "";
    this.fix = problem.fix ?? "";
  }
}

// The token or session is not valid any more: the page offers to sign in, so that no view says what was refused.
export class SignedOut extends Refused {}

type Body = object | string | Uint8Array<ArrayBuffer> | undefined;

function typeOf(body: object | string): string {
  if (body instanceof Blob) return body.type;
  return typeof body === "string" ? "text/plain" : body instanceof Uint8Array ? "application/octet-stream" : "application/json";
}

interface Answered {
  text: string;
  tag: string; // its ETag; '' without one
}

// A text, bytes or a file are sent as they are, anything else as JSON.
async function fetched(method: string, path: string, body: Body, signal?: AbortSignal): Promise<Answered> {
  const options: RequestInit = { method, headers: {}, signal: signal ?? null };
  if (body !== undefined) {
    const asItIs = typeof body === "string" || body instanceof Uint8Array || body instanceof Blob;
    options.headers = { "content-type": typeOf(body) };
    options.body = asItIs ? body : JSON.stringify(body);
  }
  let answer: Response;
  try {
    answer = await fetch(`${API}${path}`, options);
  } catch (error) {
    if (signal?.aborted) throw error;
    noteSilence();
    throw new Refused(0, { what: t("the service does not answer"), where: "", fix: "" });
  }
  noteAnswer();
  noteDate(answer.headers.get("date"));
  const text = await answer.text();
  if (answer.ok) return { text, tag: (answer.headers.get("etag") ?? "").replace(/^(?:W\/)?"|"$/g, "") };
  if (answer.status !== 401 || path === "/session") throw new Refused(answer.status, problemOf(answer.status, text));
  if (path !== WHO) noteUnknown();
  throw new SignedOut(answer.status, problemOf(answer.status, text));
}

function problemOf(status: number, text: string): Problem {
  try {
    return JSON.parse(text) as Problem;
  } catch { // a proxy's answer
    return { what: t("status {status}", { status }), where: "", fix: "" };
  }
}

export async function ask<T>(method: string, path: string, body?: Body, signal?: AbortSignal): Promise<T> {
  const { text } = await fetched(method, path, body, signal);
  return (text ? JSON.parse(text) : null) as T;
}

export const get = <T>(path: string, signal?: AbortSignal): Promise<T> => ask<T>("GET", path, undefined, signal);

const TWICE_MS = 1000;
let last: { what: string; answer: Promise<unknown>; untilMs: number } | null = null;

// What was asked last and is asked again at once is the same: a double click queues one run and leaves one note.
export function post<T>(path: string, body?: object): Promise<T> {
  const what = path + JSON.stringify(body ?? null, (name, value: unknown) => (name === "key" ? undefined : value));
  if (last?.what === what && Date.now() < last.untilMs) return last.answer as Promise<T>;
  const answer = ask<T>("POST", path, body);
  const mine = { what, answer, untilMs: Infinity };
  last = mine;
  answer.then(() => { mine.untilMs = Date.now() + TWICE_MS; }, () => { if (last === mine) last = null; });
  return answer;
}

export const getText = async (path: string, signal?: AbortSignal): Promise<string> => (await fetched("GET", path, undefined, signal)).text;
// With what a newer text names it by that replaces it.
export const getTagged = (path: string, signal?: AbortSignal): Promise<Answered> => fetched("GET", path, undefined, signal);
export const fileUrl = (run: number, name: string): string => `${API}/runs/${run}/files/${encodeURIComponent(name)}`;

export const STOP_MS = 600_000; // how long a stop is tried: a service that is started again must not go on with its queue
const AGAIN_MS = 50, LATER_MS = 500; // from one try to the next, for half a minute and then
const SOON_MS = 30_000;
const AWAY = [502, 503, 504]; // a proxy's, while the service behind it is away
let stopUrl = "";

// Where the service takes emergency stops whatever else it does: asked beforehand, for a flooded service answers late.
export async function findStopPost(): Promise<void> {
  stopUrl = (await get<Health>("/health")).stop_url ?? "";
}

// Both ways at the same moment; the first that has taken it is enough. A flooded service closes connections: a way
// on which no one answers is tried again. `service` settles once the service itself has answered, or is given up.
// Throws the refusal, or null where no one has answered.
export async function stopNow(bench: string): Promise<{ service: Promise<void> }> {
  const path = bench ? `/benches/${encodeURIComponent(bench)}/emergency-stop` : "/emergency-stop";
  const control = new AbortController(), late = control.signal; // also for a way that is never answered
  const timer = setTimeout(() => control.abort(), STOP_MS);
  const service = insist(() => ask("POST", path, undefined, late), late), ways = [service];
  if (stopUrl) ways.push(insist(() => byStopPost(path, late), late));
  void Promise.allSettled(ways).then(() => clearTimeout(timer));
  try {
    await Promise.any(ways);
    return { service };
  } catch (error) {
    throw (error as AggregateError).errors.find((one) => one instanceof Refused && one.status) ?? null;
  }
}

async function byStopPost(path: string, signal: AbortSignal): Promise<void> {
  const answer = await fetch(`${stopUrl}${API}${path}`, { method: "POST", credentials: "include", signal });
  if (!answer.ok) throw new Refused(answer.status, problemOf(answer.status, await answer.text()));
}

async function insist(way: () => Promise<unknown>, late: AbortSignal): Promise<void> {
  const began = Date.now();
  for (;;) {
    try {
      await way();
      return;
    } catch (error) {
      if ((error instanceof Refused && error.status && !AWAY.includes(error.status)) || late.aborted) throw error;
      await new Promise((resolve) => setTimeout(resolve, Date.now() - began < SOON_MS ? AGAIN_MS : LATER_MS));
    }
  }
}
