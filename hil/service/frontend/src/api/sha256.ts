// SHA-256 (FIPS 180-4) of what comes in pieces: the browser's own takes a whole only, and none without TLS.

const K = new Uint32Array(64), START = new Uint32Array(8);

// The first 32 bits of the fractional parts of roots of the first primes.
for (let prime = 2, count = 0; count < 64; prime += 1) {
  let divisor = 2;
  while (divisor * divisor <= prime && prime % divisor) divisor += 1;
  if (divisor * divisor <= prime) continue;
  if (count < 8) START[count] = fraction(Math.sqrt(prime));
  K[count] = fraction(Math.cbrt(prime));
  count += 1;
}

function fraction(root: number): number {
  return Math.floor((root - Math.floor(root)) * 2 ** 32);
}

const BLOCK = 64;

export class Sha256 {
  private readonly state = START.slice();
  private readonly rest = new Uint8Array(BLOCK);
  private readonly words = new Uint32Array(64);
  private length = 0;

  update(piece: Uint8Array): this {
    let at = 0, held = this.length % BLOCK;
    this.length += piece.length;
    if (held) {
      const taken = Math.min(BLOCK - held, piece.length);
      this.rest.set(piece.subarray(0, taken), held);
      at = taken;
      held += taken;
      if (held < BLOCK) return this;
      this.take(this.rest, 0);
    }
    for (; at + BLOCK <= piece.length; at += BLOCK) this.take(piece, at);
    this.rest.set(piece.subarray(at));
    return this;
  }

  // Hexadecimal; nothing can be added afterwards.
  digest(): string {
    const bits = this.length * 8, held = this.length % BLOCK;
    const end = new Uint8Array(held < 56 ? BLOCK - held : 2 * BLOCK - held), view = new DataView(end.buffer);
    end[0] = 0x80;
    view.setUint32(end.length - 8, Math.floor(bits / 2 ** 32));
    view.setUint32(end.length - 4, bits >>> 0);
    this.update(end);
    return Array.from(this.state, (word) => word.toString(16).padStart(8, "0")).join("");
  }

  private take(data: Uint8Array, at: number): void {
    const w = this.words, s = this.state;
    for (let i = 0; i < 16; i += 1) {
      const from = at + 4 * i;
      w[i] = (data[from]! << 24) | (data[from + 1]! << 16) | (data[from + 2]! << 8) | data[from + 3]!;
    }
    for (let i = 16; i < 64; i += 1) {
      const x = w[i - 15]!, y = w[i - 2]!;
      const low = ((x >>> 7) | (x << 25)) ^ ((x >>> 18) | (x << 14)) ^ (x >>> 3);
      const high = ((y >>> 17) | (y << 15)) ^ ((y >>> 19) | (y << 13)) ^ (y >>> 10);
      w[i] = (w[i - 16]! + low + w[i - 7]! + high) | 0;
    }
    let [a, b, c, d, e, f, g, h] = s as unknown as [number, number, number, number, number, number, number, number];
    for (let i = 0; i < 64; i += 1) {
      const sum1 = ((e >>> 6) | (e << 26)) ^ ((e >>> 11) | (e << 21)) ^ ((e >>> 25) | (e << 7));
      const first = (h + sum1 + ((e & f) ^ (~e & g)) + K[i]! + w[i]!) | 0;
      const sum0 = ((a >>> 2) | (a << 30)) ^ ((a >>> 13) | (a << 19)) ^ ((a >>> 22) | (a << 10));
      const second = (sum0 + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      h = g; g = f; f = e; e = (d + first) | 0; d = c; c = b; b = a; a = (first + second) | 0;
    }
    [a, b, c, d, e, f, g, h].forEach((word, i) => { s[i] = (s[i]! + word) | 0; });
  }
}

export const sha256Of = (piece: Uint8Array): string => new Sha256().update(piece).digest();
