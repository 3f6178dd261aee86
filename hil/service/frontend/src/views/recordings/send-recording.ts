// A recording on its way to the service: in pieces, gone on with where an earlier try ended.

import { ask, get, post, Refused } from "../../api/client.ts";
import { Sha256, sha256Of } from "../../api/sha256.ts";
import type { Recording } from "../../api/types.ts";
import { t } from "../../i18n/text.ts";

const PIECE = 1_000_000;
const AGAIN_MS = 1000;
const GONE_MS = 60_000;
const BUSY = [0, 429, 503];

// A name that the service takes: letters, digits, _ . and -.
export const nameFor = (file: string): string =>
  file.replace(/[^A-Za-z0-9_.-]+/g, "-").replace(/^[^A-Za-z0-9]+/, "").slice(-100) || "recording";

// What is written into the form, a column a line.
export const columnsFrom = (text: string): string[] => text.split("\n").map((line) => line.trim()).filter(Boolean);

export const emptyFile = (name: string): Error => new Error(t("The file {name} is empty and was not taken. Choose one with something in it.", { name }));

export interface Sending {
  file: File;
  columns: string[];
  me: string;
  signal: AbortSignal;
  onShare: (share: number) => void;
}

export async function sendRecording({ file, columns, me, signal, onShare }: Sending): Promise<Recording> {
  if (!file.size) throw emptyFile(file.name);
  const name = nameFor(file.name);
  const one = await begun(name, file.size, columns, me);
  const whole = new Sha256();
  for (let at = 0; at < file.size; at += PIECE) {
    const piece = new Uint8Array(await file.slice(at, at + PIECE).arrayBuffer());
    signal.throwIfAborted();
    whole.update(piece);
    if (at + piece.length > one.received) await sendPiece(one.id, at, piece, signal);
    onShare((at + piece.length) / file.size);
  }
  return post<Recording>(`/recordings/${one.id}/ending`, { sha256: whole.digest() });
}

async function begun(name: string, size: number, columns: string[], me: string): Promise<Recording> {
  const same = (one: Recording) => one.name === name && one.size === size && one.columns.join("\n") === columns.join("\n");
  const there = (await get<Recording[]>("/recordings")).find((one) => one.state === "arriving" && !one.place && one.given_by === me && same(one));
  return there ?? post<Recording>("/recordings", { name, size, columns });
}

// Of a piece that is there in part, the rest.
async function sendPiece(id: number, at: number, piece: Uint8Array<ArrayBuffer>, signal: AbortSignal): Promise<void> {
  const untilMs = Date.now() + GONE_MS;
  for (let there = at; there < at + piece.length;) {
    const rest = piece.subarray(there - at);
    try {
      there = (await ask<{ size: number }>("PUT", `/recordings/${id}/content?at=${there}&sha256=${sha256Of(rest)}`, rest, signal)).size;
      if (there < at) throw new Error(t("the service has lost what was sent; give it again"));
    } catch (error) {
      if (!(error instanceof Refused) || !BUSY.includes(error.status) || Date.now() > untilMs) throw error;
      await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
      signal.throwIfAborted();
    }
  }
}
