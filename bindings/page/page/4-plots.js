// Strip charts of the last seconds.
const SPAN = 12;
const nice = (most) => { const p = 10 ** Math.floor(Math.log10(most)); return [1, 2, 5, 10].map((k) => k * p).find((k) => k >= most); };
function plot(canvas, lines, limit, least) {
  const c = canvas.getContext("2d");
  sharpen(canvas, c);
  const w = canvas.clientWidth, h = canvas.clientHeight, left = 34, rows = history.rows;
  const end = rows.length ? rows[rows.length - 1].t : 0, begin = Math.max(0, end - SPAN);
  let first = rows.length;
  while (first > 0 && rows[first - 1].t >= begin) first--;
  let most = least;
  for (let i = first; i < rows.length; i++) for (const [pick] of lines) { const v = Math.abs(pick(rows[i].main)); if (v > most) most = v; }
  most = nice(most);
  const X = (t) => left + ((t - begin) / SPAN) * (w - left - 2), Y = (v) => h / 2 - (v / most) * (h / 2 - 6);
  c.font = "10px system-ui, sans-serif"; c.textAlign = "right"; c.textBaseline = "middle"; c.fillStyle = ink.soft;
  for (const v of [most, 0, -most]) {
    c.strokeStyle = v ? ink.grid : ink.grid2; c.lineWidth = 1;
    c.beginPath(); c.moveTo(left, Y(v)); c.lineTo(w, Y(v)); c.stroke();
    c.fillText(v ? (v > 0 ? "" : "−") + Math.abs(v) : "0", left - 5, Y(v));
  }
  for (let t = Math.ceil(begin / 2) * 2; t <= begin + SPAN; t += 2) { c.strokeStyle = ink.grid; c.beginPath(); c.moveTo(X(t), 2); c.lineTo(X(t), h - 2); c.stroke(); }
  if (limit && limit <= most) { c.strokeStyle = alpha(ink.bad, 0.45); c.setLineDash([3, 4]); for (const s of [1, -1]) { c.beginPath(); c.moveTo(left, Y(s * limit)); c.lineTo(w, Y(s * limit)); c.stroke(); } c.setLineDash([]); }
  const step = Math.max(1, Math.floor((rows.length - first) / (2 * w)));
  for (const [pick, colour] of lines) {
    c.strokeStyle = ink[colour]; c.lineWidth = 1.6; c.lineJoin = "round"; c.beginPath();
    let pen = false;
    for (let i = first; i < rows.length; i += step) {
      const v = pick(rows[i].main);
      if (!Number.isFinite(v)) { pen = false; continue; }
      pen ? c.lineTo(X(rows[i].t), Y(v)) : c.moveTo(X(rows[i].t), Y(v));
      pen = true;
    }
    c.stroke();
  }
}
function drawPlots() {
  const b = (!board.on && status && status.base) || {};
  const [v, w, t] = document.querySelectorAll("[data-plot]");
  plot(v, [[(m) => m.vc, "c0"], [(m) => m.v, "c1"]], b.speed, 0.1);
  plot(w, [[(m) => m.wc, "c0"], [(m) => m.w, "c1"]], b.turn_rate, 0.2);
  plot(t, [[(m) => m.tl, "c2"], [(m) => m.tr, "c1"]], b.torque, 0.1);
}
