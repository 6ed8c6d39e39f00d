// What has happened: columns of numbers, of the simulation or of a board, the newest last.
const KEEP = 40000;
class History {
  constructor() { this.clear(); }
  clear() { this.n = 0; this.rows = []; }
  push(row) {
    this.rows.push(row); this.n++;
    if (this.rows.length > 1.25 * KEEP) this.rows.splice(0, this.rows.length - KEEP);
  }
  get last() { return this.rows[this.rows.length - 1]; }
}
const history = new History();
const bitsOf = (() => { const f = new Float32Array(1), u = new Uint32Array(f.buffer); return (v) => { f[0] = v; return u[0]; }; })();

// Rows of the simulation: see `session.rs`.
function takeRows() {
  const all = numbers(wasm.rows()), bits = new Uint32Array(all.buffer), { row, robot } = about;
  for (let i = 0; i < all.length; i += row) {
    const one = (k) => {
      const o = i + 1 + k * robot;
      if (Number.isNaN(all[o])) return null;
      return { x: all[o], y: all[o + 1], a: all[o + 2], bx: all[o + 3], by: all[o + 4], ba: all[o + 5], v: all[o + 6], w: all[o + 7], vc: all[o + 8], wc: all[o + 9], tr: all[o + 10], tl: all[o + 11], state: bits[o + 12], faults: bits[o + 13] };
    };
    history.push({ t: all[i], main: one(0), others: [one(1), one(2)] });
  }
}

// Reports of a board: see `watch.rs`. How long a tick is, a board says only if it is asked; else it shows after a second.
const board = { on: false, reports: 0, tick: 0.001, known: false, begun: 0, cause: "", drawn: 0 };
function takeReports() {
  const all = numbers(wasm.board_rows()), bits = new Uint32Array(all.buffer), n = about.watched;
  for (let i = 0; i < all.length; i += n) {
    const f = (k) => all[i + k];
    history.push({ tick: f(0), t: f(0) * board.tick, others: [], main: { x: f(1), y: f(2), a: f(3), bx: f(1), by: f(2), ba: f(3), v: f(4), w: f(5), vc: f(6), wc: f(7), tr: f(8), tl: f(9), ex: f(10), ey: f(11), ea: f(12), state: bits[i + 13], faults: bits[i + 14] } });
  }
  const passed = (performance.now() - board.begun) / 1000;
  if (!board.known && all.length && passed > 1 && history.last.tick > 0) retime(passed / history.last.tick, passed > 4);
}
function retime(tick, known) {
  board.known = known; board.tick = tick;
  for (const row of history.rows) row.t = row.tick * tick;
}
