// Recordings on their way to the service: their SHA-256 in pieces, the name that the service takes, columns.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import test from "node:test";
import { Sha256, sha256Of } from "../../../../hil/service/frontend/src/api/sha256.ts";
import { columnsFrom, nameFor, sendRecording } from "../../../../hil/service/frontend/src/views/recordings/send-recording.ts";

const numbers = (count: number): Uint8Array => Uint8Array.from({ length: count }, (_, at) => (at * 131 + (at >> 7)) % 256);
const expected = (data: Uint8Array): string => createHash("sha256").update(data).digest("hex");

test("SHA-256 is that of the standard, at every length around a block", () => {
  assert.equal(sha256Of(new TextEncoder().encode("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  for (let count = 0; count <= 200; count += 1) assert.equal(sha256Of(numbers(count)), expected(numbers(count)), String(count));
});

test("SHA-256 is the same in whatever pieces the data come", () => {
  const data = numbers(1_000_003);
  for (const size of [1_000_000, 4097, 64, 63]) {
    const whole = new Sha256();
    for (let at = 0; at < data.length; at += size) whole.update(data.subarray(at, at + size));
    assert.equal(whole.digest(), expected(data), String(size));
  }
});

test("a file's name becomes one that the service takes, with its ending", () => {
  assert.equal(nameFor("Fahrt 3 (kalt).mf4"), "Fahrt-3-kalt-.mf4");
  assert.equal(nameFor("../.hidden.csv"), "hidden.csv");
  assert.equal(nameFor(`${"x".repeat(300)}.mcap`).length, 100);
  assert.ok(nameFor(`${"x".repeat(300)}.mcap`).endsWith(".mcap"));
  assert.equal(nameFor("…"), "recording");
});

test("columns stand one a line", () => {
  assert.deepEqual(columnsFrom(" time_s=t, unit=ms \n\nmotor_speed_rad_s=n_EM\n"), ["time_s=t, unit=ms", "motor_speed_rad_s=n_EM"]);
});

test("an empty file is refused by its name before it is sent", async () => {
  const sending = { file: new File([], "drive.csv"), columns: [], me: "anna", signal: new AbortController().signal, onShare: () => {} };
  await assert.rejects(sendRecording(sending), /The file drive\.csv is empty/);
});
