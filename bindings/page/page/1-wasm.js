"use strict";
const $ = (id) => document.getElementById(id);

// The program: an LZMA stream, a letter of the page's encoding for each byte. "=" stands before those that HTML does not keep, moved by 64.
// What browsers unpack by themselves, base64 of gzip, would be 180 kB more.
function fromLetters(text) {
  const letters = new TextDecoder("windows-1252").decode(Uint8Array.from({ length: 256 }, (_, i) => i));
  const byte = new Uint8Array(1 << 16), out = new Uint8Array(text.length);
  for (let i = 0; i < 256; i++) byte[letters.charCodeAt(i)] = i;
  let o = 0;
  for (let i = 0; i < text.length; i++) out[o++] = text[i] === "=" ? byte[text.charCodeAt(++i)] - 64 : byte[text.charCodeAt(i)];
  return out;
}

function unpack(packed, size) {
  const out = new Uint8Array(size), LC = 4;
  const probs = (n) => new Uint16Array(n).fill(1024);
  let at = 1, range = 0xffffffff, code = 0;
  for (let i = 0; i < 4; i++) code = ((code << 8) | packed[at++]) >>> 0;
  const bit = (p, i) => {
    const bound = (range >>> 11) * p[i];
    let b = 0;
    if (code < bound) { range = bound; p[i] += (2048 - p[i]) >> 5; }
    else { range = (range - bound) >>> 0; code = (code - bound) >>> 0; p[i] -= p[i] >> 5; b = 1; }
    if (range < 0x1000000) { range = (range << 8) >>> 0; code = ((code << 8) | packed[at++]) >>> 0; }
    return b;
  };
  const tree = (p, from, bits) => { let m = 1; for (let i = 0; i < bits; i++) m = (m << 1) | bit(p, from + m); return m - (1 << bits); };
  const back = (p, from, bits) => { let m = 1, v = 0; for (let i = 0; i < bits; i++) { const b = bit(p, from + m); m = (m << 1) | b; v |= b << i; } return v; };
  const lengths = () => ({ choice: probs(2), low: probs(8), mid: probs(8), high: probs(256) });
  const length = (l) => !bit(l.choice, 0) ? tree(l.low, 0, 3) : !bit(l.choice, 1) ? 8 + tree(l.mid, 0, 3) : 16 + tree(l.high, 0, 8);
  const literal = probs(0x300 << LC), match = probs(12), rep = probs(12), g0 = probs(12), g1 = probs(12), g2 = probs(12), long0 = probs(12);
  const slot = probs(256), special = probs(128), align = probs(16), lenMatch = lengths(), lenRep = lengths();
  let state = 0, r0 = 0, r1 = 0, r2 = 0, r3 = 0, n = 0;
  while (n < size) {
    if (!bit(match, state)) {
      const from = 0x300 * ((n ? out[n - 1] : 0) >> (8 - LC));
      let m = 1;
      if (state >= 7) {
        let other = out[n - r0 - 1];
        do { const o = other >> 7; other = (other << 1) & 255; const b = bit(literal, from + ((1 + o) << 8) + m); m = (m << 1) | b; if (o !== b) break; } while (m < 256);
      }
      while (m < 256) m = (m << 1) | bit(literal, from + m);
      out[n++] = m;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let len;
    if (!bit(rep, state)) {
      r3 = r2; r2 = r1; r1 = r0;
      len = length(lenMatch);
      state = state < 7 ? 7 : 10;
      const s = tree(slot, 64 * Math.min(len, 3), 6);
      if (s < 4) r0 = s;
      else {
        const direct = (s >> 1) - 1;
        r0 = (2 | (s & 1)) << direct;
        if (s < 14) r0 += back(special, r0 - s, direct);
        else {
          let v = 0;
          for (let i = direct - 4; i > 0; i--) {
            range >>>= 1;
            const b = code >= range ? 1 : 0;
            if (b) code = (code - range) >>> 0;
            if (range < 0x1000000) { range = (range << 8) >>> 0; code = ((code << 8) | packed[at++]) >>> 0; }
            v = (v << 1) | b;
          }
          r0 += (v << 4) + back(align, 0, 4);
        }
      }
    } else {
      if (!bit(g0, state)) {
        if (!bit(long0, state)) { state = state < 7 ? 9 : 11; out[n] = out[n - r0 - 1]; n++; continue; }
      } else if (!bit(g1, state)) { [r0, r1] = [r1, r0]; }
      else if (!bit(g2, state)) { [r0, r1, r2] = [r2, r0, r1]; }
      else { [r0, r1, r2, r3] = [r3, r0, r1, r2]; }
      len = length(lenRep);
      state = state < 7 ? 8 : 11;
    }
    for (len += 2; len > 0; len--, n++) out[n] = out[n - r0 - 1];
  }
  return out;
}

const fromBase64 = (text) => { const s = atob(text), b = new Uint8Array(s.length); for (let i = 0; i < b.length; i++) b[i] = s.charCodeAt(i); return b; };
const toBase64 = (bytes) => { let s = ""; for (let i = 0; i < bytes.length; i += 8192) s += String.fromCharCode(...bytes.subarray(i, i + 8192)); return btoa(s); };

let wasm, about, started = performance.now();
const view = () => new Uint8Array(wasm.memory.buffer, wasm.output(), wasm.output_length());
const said = () => new TextDecoder().decode(view());
function send(bytes) {
  // Room first: memory that grows for it is another buffer.
  const at = wasm.input(bytes.length);
  if (!at) throw new Error("too much at once: 2 MB are the most");
  new Uint8Array(wasm.memory.buffer, at, bytes.length).set(bytes);
}
const numbers = (count) => new Float32Array(wasm.memory.buffer.slice(wasm.output(), wasm.output() + 4 * count));

async function load() {
  const { size } = $("wasm").dataset;
  const bytes = unpack(fromLetters($("wasm").textContent), +size);
  $("wasm").textContent = "";
  wasm = (await WebAssembly.instantiate(bytes, {})).instance.exports;
  wasm.about();
  about = JSON.parse(said());
}

// Inputs as bytes: see `input.rs`.
// Places are words of millimetres: so far from its middle the floor ends.
const FLOOR = 32.767;
const onFloor = ([x, y, ...more]) => [...[x, y].map((v) => Math.max(-FLOOR, Math.min(FLOOR, v))), ...more];
const clamp = (v, most) => Math.max(-most, Math.min(most, Math.round(v)));
const word = (v) => { const n = clamp(v, 32767) & 0xffff; return [n & 255, n >> 8]; };
const wrap = (a) => Math.atan2(Math.sin(a), Math.cos(a));
const at = (p) => [...word(1000 * p[0]), ...word(1000 * p[1]), ...word(10000 * wrap(p[2]))];
const block = (bytes) => { const n = bytes.length, out = new Uint8Array(n + 4); new DataView(out.buffer).setUint32(0, n, true); out.set(bytes, 4); return out; };
const utf8 = (text) => block(new TextEncoder().encode(text));
const setting = (s) => [s.base, s.gyro ? 1 : 0, s.floor, s.seed & 255, (s.seed >> 8) & 255];
const join = (...parts) => { const out = new Uint8Array(parts.reduce((n, p) => n + p.length, 0)); let i = 0; for (const p of parts) { out.set(p, i); i += p.length; } return out; };
const INPUT = {
  begin: (s) => [0, ...setting(s)],
  robot: (s, name, text) => join([1, ...setting(s)], utf8(name), utf8(text)),
  laws: (mask) => [2, mask],
  goal: (p) => [3, ...at(p)],
  place: (p, announced) => [4, announced ? 1 : 0, ...at(p)],
  line: (points) => [5, points.length & 255, points.length >> 8, ...points.flatMap((p) => [...word(1000 * p[0]), ...word(1000 * p[1])])],
  file: (name, bytes) => join([6], utf8(name), block(bytes)),
  drive: (v, w) => [7, ...word(1000 * v), ...word(1000 * w)],
  stop: () => [8], estop: () => [9], arm: () => [10],
  push: (fx, fy, moment, s) => [11, ...word(10 * fx), ...word(10 * fy), ...word(100 * moment), ...word(1000 * s)],
  ice: (x0, x1, y0, y1, mu) => [12, Math.max(1, Math.round(100 * mu)), ...[x0, x1, y0, y1].flatMap((v) => word(1000 * v))],
  thaw: () => [13],
  fault: (n, on) => [14, n, on ? 1 : 0],
  host: (alive) => [15, alive ? 1 : 0],
};
